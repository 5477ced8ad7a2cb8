"""The reciprocating elastic punch on an elastic strip, cold or hot, with scikit-fem: a finite-element model as an expert
would set it up for this scene, with every factor kept.

Reads the scene as JSON from standard input and writes one JSON object per run (see fmu-build/lab/src/chart/peers.rs).

Both bodies are meshed with quadrilaterals of second order, graded to the ends of the contact and to the contact
line. Their stiffness matrices are factorised once and condensed onto the contact line: normal and shear compliance of N
cells with uniform pressure each. Heat is stepped in each body by BDF2 with a constant step, so that its matrix is factorised
once as well; the strip is at rest in its own frame and the cells move over it. Within a step pressure, wear, heat split,
temperature and thermal distortion are iterated to a fixed point; an iteration costs one back-substitution for heat and one
for distortion in each body. The pressure follows from an active-set solution of the N x N complementarity problem, with
the wear of the step implicit in it. Without thermal expansion the distortion is left out, and heat is stepped after the
pressure.
"""

import json
import sys
import time

import numpy as np
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad0,
    ElementQuad2,
    ElementVector,
    FacetBasis,
    MeshQuad,
)
from skfem.helpers import ddot, div, dot, eye, grad, sym_grad

FIXED_POINT = 1e-4  # change of the pressure, over the mean, that ends the iteration of a step
MOST_ITERATIONS = 20


@BilinearForm
def conduction(u, v, _):
    return dot(grad(u), grad(v))


@BilinearForm
def product(u, v, _):
    return u * v


@BilinearForm
def normal_load(p, v, _):
    # Positive into a body that lies in z > 0.
    return p * v[1]


@BilinearForm
def shear_load(p, v, _):
    return p * v[0]


class Material:
    def __init__(self, value, body):
        modulus, ratio = value[f"{body}.youngs_modulus"], value[f"{body}.poissons_ratio"]
        self.lame = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
        self.shear = modulus / (2 * (1 + ratio))
        self.expansion = value[f"{body}.thermal_expansion"]
        self.conductivity = value[f"{body}.conductivity"]
        self.capacity = value[f"{body}.density"] * value[f"{body}.specific_heat"]
        self.convection = value[f"{body}.convection"]


class Body:
    """A block whose contact face is z = 0, z into the body, held in place and temperature at the far face."""

    def __init__(self, material, x, z, cooled_sides):
        self.material = material
        mesh = MeshQuad.init_tensor(x, z)
        self.scalar = Basis(mesh, ElementQuad2(), intorder=4)
        self.vector = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
        height = z[-1]
        surface = mesh.facets_satisfying(lambda at: np.isclose(at[1], 0.0))
        order = np.argsort(mesh.p[0, mesh.facets[:, surface]].mean(axis=0))
        surface = surface[order]
        elements = mesh.f2t[0, surface]
        self.edges = np.unique(mesh.p[0, mesh.facets[:, surface]])
        self.lengths = np.diff(self.edges)
        constant, scalar, vector = (
            FacetBasis(mesh, element, facets=surface, intorder=4)
            for element in (ElementQuad0(), ElementQuad2(), ElementVector(ElementQuad2()))
        )

        def of_surface(form, test):
            return form.assemble(constant, test)[:, elements].tocsc()

        self.heat_in = of_surface(product, scalar)
        self.pressed = of_surface(normal_load, vector)
        self.sheared = of_surface(shear_load, vector)

        lame, shear = material.lame, material.shear

        @BilinearForm
        def stiffness(u, v, _):
            strain = sym_grad(u)
            return ddot(lame * eye(np.trace(strain), 2) + 2 * shear * strain, sym_grad(v))

        bulk = (3 * lame + 2 * shear) * material.expansion

        @BilinearForm
        def thermal_load(temperature, v, _):
            return bulk * temperature * div(v)

        self.held = self.vector.get_dofs(lambda at: np.isclose(at[1], height)).all()
        self.free = np.setdiff1d(np.arange(self.vector.N), self.held)
        matrix = stiffness.assemble(self.vector)
        self.elastic = splu(matrix[self.free][:, self.free].tocsc())
        self.thermal = thermal_load.assemble(self.scalar, self.vector)[self.free].tocsr()

        self.cold = self.scalar.get_dofs(lambda at: np.isclose(at[1], height)).all()
        self.warm = np.setdiff1d(np.arange(self.scalar.N), self.cold)
        cooled = [surface] if not cooled_sides else [
            mesh.facets_satisfying(lambda at: np.isclose(at[0], x[0]) | np.isclose(at[0], x[-1]))
        ]
        air = product.assemble(FacetBasis(mesh, ElementQuad2(), facets=np.concatenate(cooled)))
        conducting = material.conductivity * conduction.assemble(self.scalar) + material.convection * air
        self.conduction = conducting[self.warm][:, self.warm].tocsc()
        self.mass = material.capacity * product.assemble(self.scalar)[self.warm][:, self.warm].tocsc()

    def prepare(self, step):
        """Factors of the first (Euler) and of all later (BDF2) steps."""
        self.euler = splu((self.mass / step + self.conduction).tocsc())
        self.bdf2 = splu((1.5 * self.mass / step + self.conduction).tocsc())

    def compliance(self):
        """Mean displacement into the body of every cell per pressure and per shear traction on every cell."""
        means = self.pressed[self.free].toarray().T / self.lengths[:, None]
        pressed, sheared = (self.elastic.solve(load[self.free].toarray()) for load in (self.pressed, self.sheared))
        return means @ pressed, means @ sheared

    def temperature_means(self, temperature):
        return (self.heat_in[self.warm].T @ temperature) / self.lengths

    def distortion(self, temperature):
        """Mean thermal displacement of every surface element into the body."""
        displaced = self.elastic.solve(self.thermal[:, self.warm] @ temperature)
        return (self.pressed[self.free].T @ displaced) / self.lengths


def graded(count, half_width):
    """Edges of `count` cells from -half_width to half_width, graded to both."""
    return half_width * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, count + 1))


def geometric(first, ratio, last):
    """Depths from 0 to `last`, the first layer `first` thick, each next one `ratio` times thicker."""
    count = int(np.ceil(np.log(1 + last * (ratio - 1) / first) / np.log(ratio)))
    depths = first * (ratio ** np.arange(count + 1) - 1) / (ratio - 1)
    return depths * last / depths[-1]


class Contact:
    """The complementarity problem of the cells: A p + gap - approach >= 0, p >= 0 under a load."""

    def __init__(self, lengths):
        self.lengths = lengths
        self.active = np.ones(lengths.size, dtype=bool)

    def solve(self, matrix, gap, load):
        for _ in range(60):
            on = np.flatnonzero(self.active)
            size = on.size
            system = np.empty((size + 1, size + 1))
            system[:size, :size] = matrix[np.ix_(on, on)]
            system[:size, size] = -1.0
            system[size, :size] = self.lengths[on]
            system[size, size] = 0.0
            solution = np.linalg.solve(system, np.append(-gap[on], load))
            pressure = np.zeros(gap.size)
            pressure[on] = solution[:size]
            open_gap = matrix @ pressure + gap - solution[size]
            scale = load / self.lengths.sum()
            leaving = self.active & (pressure < 0.0)
            entering = ~self.active & (open_gap < -1e-12 * np.abs(matrix).max() * scale)
            if not (leaving.any() or entering.any()):
                return pressure
            self.active = (self.active & ~leaving) | entering
        raise RuntimeError("the active set does not settle")


class Model:
    def __init__(self, scene, count, layers, step):
        value = scene["parameters"]
        self.value, self.step = value, step
        half_width = 0.5 * value["punch.width"]
        self.edges = graded(count, half_width)
        self.lengths = np.diff(self.edges)
        punch, strip = Material(value, "punch"), Material(value, "strip")
        first = value["punch.width"] / layers
        self.hot = punch.expansion > 0.0 or strip.expansion > 0.0

        up = geometric(0.5 * self.lengths[0], 1.6, value["punch.height"])
        self.punch = Body(punch, self.edges, up, True)
        # Elasticity of the strip on a mesh that meets the cells; it is the same wherever the punch stands.
        beside = half_width + geometric(self.lengths[0], 1.6, 4.0 * value["strip.height"])[1:]
        x = np.concatenate((-beside[::-1], self.edges, beside))
        meeting = Body(strip, x, geometric(0.5 * self.lengths[0], 1.6, value["strip.height"]), False)
        inside = np.searchsorted(meeting.edges, self.edges[:-1] + 1e-9 * half_width) - 1
        normal, shear = (matrix[np.ix_(inside, inside)] for matrix in meeting.compliance())
        # Heat and distortion of the strip on a mesh of its own, even where the punch comes by.
        reach = half_width + 1.1 * max(value["nominal.stroke"], 1e-9) / 2
        even = np.linspace(-reach, reach, max(2, int(round(2 * reach / first))) + 1)
        beside = reach + geometric(first, 1.5, 4.0 * value["strip.height"])[1:]
        x = np.concatenate((-beside[::-1], even, beside))
        self.strip = Body(strip, x, geometric(0.25 * first, 1.5, value["strip.height"]), False)
        for body in (self.punch, self.strip):
            body.prepare(step)
        own_normal, own_shear = self.punch.compliance()
        self.normal = own_normal + normal
        # Friction acts on the punch against the velocity, on the strip along it.
        self.shear = shear - own_shear if value["contact.shear_coupling"] else np.zeros_like(normal)
        self.response = {}

    def over(self, position):
        """Part of every cell that lies over every surface element of the strip when the punch is at `position`."""
        left = np.maximum(self.strip.edges[:-1, None], position + self.edges[None, :-1])
        right = np.minimum(self.strip.edges[1:, None], position + self.edges[None, 1:])
        return np.maximum(right - left, 0.0)

    def run(self, inputs, samples, stations):
        value, step = self.value, self.step
        count = self.lengths.size
        wear = value["punch.wear_coefficient"] * value["wear_acceleration"]
        friction, conductance = value["contact.friction_coefficient"], value["contact.conductance"]
        contact = Contact(self.lengths)
        depth = value["depth"]
        time_table, velocity, load = inputs.T
        path = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(time_table) * (velocity[1:] + velocity[:-1]))))
        worn = [np.zeros(count)] * 2
        bodies = (self.punch, self.strip)
        temperature = [[np.zeros(body.warm.size)] * 2 for body in bodies]  # latest, the one before
        distorted = np.zeros(count)
        pressure = np.full(count, load[0] / depth / self.lengths.sum())
        rows, index = [], 0
        total = int(round(samples[-1] / step))
        for number in range(1, total + 1):
            now = number * step
            speed = np.interp(now, time_table, velocity)
            # The sign is that of the step: the velocity changes sign at its ends only.
            sign = np.sign(np.interp(now - 0.5 * step, time_table, velocity))
            carried = np.interp(now, time_table, load) / depth
            over = self.over(np.interp(now, time_table, path))
            first = number == 1
            weight = step if first else 2.0 * step / 3.0
            start = worn[0] if first else (4.0 * worn[0] - worn[1]) / 3.0
            rate = wear * abs(speed)
            matrix = self.normal + sign * friction * self.shear + np.diag(np.full(count, weight * rate))
            known = [
                body.mass @ (own[0] if first else 2.0 * own[0] - 0.5 * own[1]) / step
                for body, own in zip(bodies, temperature)
            ]
            factors = [body.euler if first else body.bdf2 for body in bodies]
            unheated = [factor.solve(load) for factor, load in zip(factors, known)]
            for _ in range(MOST_ITERATIONS):
                before = pressure
                pressure = contact.solve(matrix, start + distorted, carried)
                heat = friction * abs(speed) * pressure
                flux_punch, new = self.heat(unheated, factors, heat, over, conductance, pressure > 0.0)
                if not self.hot:
                    break
                distorted = bodies[0].distortion(new[0]) + (over.T @ bodies[1].distortion(new[1])) / self.lengths
                if np.abs(pressure - before).max() < FIXED_POINT * carried / self.lengths.sum():
                    break
            worn = [start + weight * rate * pressure, worn[0]]
            temperature = [[latest, own[0]] for latest, own in zip(new, temperature)]
            if index < len(samples) and abs(now - samples[index]) < 1e-6 * step:
                rows.append(self.sample(worn[0], new, over, pressure, heat, flux_punch, conductance, speed, carried, stations))
                index += 1
        return total, rows

    def heat(self, unheated, factors, heat, over, conductance, closed):
        """Flux into the punch and temperatures of both bodies at the end of the step, from those without its heat and the
        kept response of the contact faces to a flux of the step."""
        bodies = (self.punch, self.strip)
        key = id(factors[0])
        if key not in self.response:
            self.response[key] = [self.surface_response(body, own) for body, own in zip(bodies, factors)]
        own, under = self.response[key]
        punch, strip = bodies
        # Fluxes: q1 + q2 = heat, T1 - T2 = (q2 - q1)/(2 h_c); none where the gap is open.
        share = over / strip.lengths[:, None]
        mean = over.T / self.lengths[:, None]
        strip_response = mean @ (under @ share)
        gap = mean @ strip.temperature_means(unheated[1]) - punch.temperature_means(unheated[0])
        right = gap + strip_response @ heat + heat / (2 * conductance)
        on = np.flatnonzero(closed)
        system = (own + strip_response)[np.ix_(on, on)] + np.eye(on.size) / conductance
        into = np.zeros_like(heat)
        into[on] = np.linalg.solve(system, right[on])
        return into, [
            unheated[0] + factors[0].solve(punch.heat_in[punch.warm] @ into),
            unheated[1] + factors[1].solve(strip.heat_in[strip.warm] @ (share @ (heat - into))),
        ]

    @staticmethod
    def surface_response(body, factor):
        """Mean temperature of every surface element per flux into every one over a step."""
        loads = body.heat_in[body.warm].toarray()
        return (loads.T @ factor.solve(loads)) / body.lengths[:, None]

    def sample(self, worn, new, over, pressure, heat, into, conductance, speed, carried, stations):
        value = self.value
        width = self.lengths.sum()
        # The strip's side is cooler by (q1 - q2)/(2 h_c): from the fluxes, so that it is that of the cells.
        punch = self.punch.temperature_means(new[0])
        strip = punch + (2 * into - heat) / (2 * conductance)
        closed = pressure > 0.0
        under = (over.T @ self.strip.temperature_means(new[1])) / self.lengths
        strip = np.where(closed, strip, under)
        mean = 0.5 * (punch + strip) @ self.lengths / width
        primitive = np.concatenate(([0.0], np.cumsum(pressure * self.lengths)))
        edges = (np.clip((np.arange(stations + 1) - 0.5) / (stations - 1), 0.0, 1.0) - 0.5) * width
        peak = np.max(np.diff(np.interp(edges, self.edges, primitive)) / np.diff(edges))
        force = value["contact.friction_coefficient"] * carried * value["depth"] * np.sign(speed)
        depth = worn @ self.lengths / width
        return [float(depth), float(value["ambient_temperature"] + mean), float(force), float(peak)]


def main():
    scene = json.load(sys.stdin)
    inputs = np.array(scene["inputs"])
    for count, layers, refine in ((16, 40, 1), (24, 60, 1), (32, 80, 1), (32, 80, 2)):
        step = scene["step"] / refine
        begin = time.process_time()
        model = Model(scene, count, layers, step)
        ready = time.process_time()
        steps, samples = model.run(inputs, scene["samples"], scene["stations"])
        unknowns = sum(body.warm.size + body.free.size for body in (model.punch, model.strip))
        run = {
            "family": "scikit-fem, factors kept",
            "setting": f"{count} cells, {unknowns} unknowns, step {step:.4e} s",
            "initialisation": ready - begin,
            "seconds": time.process_time() - begin,
            "steps": steps,
            "samples": samples,
        }
        print(json.dumps(run), flush=True)


if __name__ == "__main__":
    main()
