"""Independent solution of the lumped model, from its tables and inputs, by another method.

Between two communication points the inputs are held, so for a scene without fade and radiation all states obey a linear
system with constant coefficients, which the matrix exponential solves exactly. `cargo fmu tables` gives the tables.

Bodies (index b: punch 1, strip 2), temperatures above ambient, fluxes per area:

    da/dt = -rate a + contact_input q_b + cooling_input c_b
    T_b   = contact_states a + contact_direct q_b + contact_cooling c_b          (strip: plus the sum of x)
    c_b   = -forced (|v|/v0)^0.8 times the temperature of the cooled surface
    dx/dt = -(rate + sigma(|v|)) x + residue q_2                                 the moving source
    q_1 + q_2 = mu p |v|,    T_1 - T_2 = (q_2 - q_1)/(2 h_c)                     where there is contact, else 0
"""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

CONTACT, COOLING = 0, 1


class Body:
    def __init__(self, table):
        self.rate = np.array(table["rate"])
        self.input = np.array(table["input"])
        self.contact = np.array(table["contact_temperature"]["states"])
        self.contact_direct = np.array(table["contact_temperature"]["direct"])
        self.cooled = np.array(table["cooled_temperature"]["states"])
        self.cooled_direct = np.array(table["cooled_temperature"]["direct"])
        self.stored = np.array(table["stored"]["states"])
        self.forced = table["forced"]
        self.area = table["area"]
        self.count = len(self.rate)
        if table["emissivity"] != 0.0:
            raise ValueError("radiation is not linear")


class Model:
    def __init__(self, tables):
        self.punch, self.strip = Body(tables["punch"]), Body(tables["strip"])
        flash = tables["flash"]
        self.flash_rate, self.flash_residue = np.array(flash["rate"]), np.array(flash["residue"])
        speed, sigma = np.array(flash["speed"]), np.array(flash["sliding_rate"])
        self.log_sigma = CubicSpline(np.log(speed), np.log(sigma))
        self.tables = tables
        n1, n2, nf = self.punch.count, self.strip.count, len(self.flash_rate)
        self.a1, self.a2 = slice(0, n1), slice(n1, n1 + n2)
        self.x = slice(n1 + n2, n1 + n2 + nf)
        # Behind the states: the integrals of both fluxes, and 1 for what is constant.
        self.integrals, self.one = (n1 + n2 + nf, n1 + n2 + nf + 1), n1 + n2 + nf + 2
        self.size = self.one + 1

    def sigma(self, speed):
        return float(np.exp(self.log_sigma(np.log(speed)))) if speed > 0.0 else 0.0

    def matrix(self, velocity, load):
        """The system matrix at constant inputs."""
        tables, speed = self.tables, abs(velocity)
        friction = tables["friction_coefficient"] * tables["power_factor"] * load / tables["contact_area"] * speed
        closed = load > 0.0
        # Unknowns u = (q1, q2, c1, c2) solve M u = R z.
        m, r = np.zeros((4, 4)), np.zeros((4, self.size))
        if closed:
            h = tables["conductance"]
            m[0, :2] = 1.0, 1.0
            r[0, self.one] = friction
            m[1, 0] = self.punch.contact_direct[CONTACT] + 0.5 / h
            m[1, 1] = -self.strip.contact_direct[CONTACT] - 0.5 / h
            m[1, 2] = self.punch.contact_direct[COOLING]
            m[1, 3] = -self.strip.contact_direct[COOLING]
            r[1, self.a1] = -self.punch.contact
            r[1, self.a2] = self.strip.contact
            r[1, self.x] = 1.0
        else:
            m[0, 0] = m[1, 1] = 1.0
        factor = speed**0.8
        for row, (body, states, flux) in enumerate(((self.punch, self.a1, 0), (self.strip, self.a2, 1)), 2):
            h = body.forced * factor
            m[row, row] = 1.0 + h * body.cooled_direct[COOLING]
            m[row, flux] = h * body.cooled_direct[CONTACT]
            r[row, states] = -h * body.cooled
        u = np.linalg.solve(m, r)
        a = np.zeros((self.size, self.size))
        for body, states, flux, cooling in ((self.punch, self.a1, 0, 2), (self.strip, self.a2, 1, 3)):
            a[states, states] = -np.diag(body.rate)
            a[states] += np.outer(body.input[CONTACT], u[flux]) + np.outer(body.input[COOLING], u[cooling])
        a[self.x, self.x] = -np.diag(self.flash_rate + self.sigma(speed))
        a[self.x] += np.outer(self.flash_residue, u[1])
        for integral, flux in zip(self.integrals, u[:2]):
            a[integral] = flux
        return a

    def run(self, inputs, step):
        """Heat received by punches and strips [J] and heat stored [J] after every step, all faces."""
        z = np.zeros(self.size)
        z[self.one] = 1.0
        scale = self.tables["faces"] * self.tables["contact_area"]
        rows = []
        for velocity, load in inputs:
            z = expm(step * self.matrix(velocity, load)) @ z
            stored = sum(
                body.area * (body.stored @ z[states])
                for body, states in ((self.punch, self.a1), (self.strip, self.a2))
            )
            rows.append((scale * z[self.integrals[0]], scale * z[self.integrals[1]], self.tables["faces"] * stored))
        return np.array(rows)
