"""Published solutions, written down from their sources (README.md) and sharing nothing with the model."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev, legendre

ArrayLike = np.ndarray | float


def stop_half_space(flux: float, duration: float, effusivity: float, time: np.ndarray) -> np.ndarray:
    """Rise (K) at the surface of a half-space whose flux (W/m2) falls linearly to 0 in `duration` (s)."""
    return 2.0 * flux / effusivity * np.sqrt(time / np.pi) * (1.0 - 2.0 * time / (3.0 * duration))


def stop_disc(
    flux: float, duration: float, height: float, conductivity: float, diffusivity: float, time: np.ndarray, terms: int = 2000
) -> np.ndarray:
    """The same for a disc insulated at the depth `height` (m): series over its modes, Duhamel's integral term by term."""
    mean = diffusivity / (conductivity * height) * flux * (time - time**2 / (2.0 * duration))
    n = np.arange(1, terms + 1)
    rate = diffusivity * (n * np.pi / height) ** 2
    decay = np.exp(-np.outer(time, rate))
    modes = (1.0 - decay) * (1.0 + 1.0 / (rate * duration)) - np.outer(time, np.ones(terms)) / duration
    return mean + 2.0 * flux * height / (conductivity * np.pi**2) * (modes / n**2).sum(axis=1)


def heated_annulus(
    radii: tuple[float, float, float],
    height: float,
    flux: Callable[[np.ndarray, float, np.ndarray], np.ndarray],
    duration: float,
    conductivity: Callable[[np.ndarray], np.ndarray],
    capacity: Callable[[np.ndarray], np.ndarray],
    start: float,
    cells: tuple[int, int] = (95, 11),
) -> tuple[np.ndarray, np.ndarray, float]:
    """Ring between the first and the last of `radii` (m), whose face takes up `flux` (W/m2) of radius, time and temperature of the
    face from the second radius on; all other faces are insulated. Radii of the cells, their faces' temperature (K) at the end, and the highest ever.

    Explicit finite volumes with the properties of the local temperature, W/(m.K) and J/(m3.K).
    """
    (inner, heated, outer), (rings, layers) = radii, cells
    edges = np.linspace(inner, outer, rings + 1)
    r, dr, dz = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0], height / layers
    field, face, highest = np.full((rings, layers), start), np.full(rings, start), start
    count = int(duration * 5.0 * conductivity(field[0, 0]) / capacity(field[0, 0]) / min(dr, dz) ** 2) + 1
    step = duration / count
    radial, axial = np.zeros((rings + 1, layers)), np.zeros((rings, layers + 1))
    for index in range(count):
        local = conductivity(field)
        radial[1:-1] = -0.5 * (local[1:] + local[:-1]) * np.diff(field, axis=0) / dr * edges[1:-1, None]
        axial[:, 1:-1] = -0.5 * (local[:, 1:] + local[:, :-1]) * np.diff(field, axis=1) / dz
        enters = np.where(r >= heated, flux(r, (index + 0.5) * step, face), 0.0)
        axial[:, -1] = -enters
        field = field - step / capacity(field) * (np.diff(radial, axis=0) / (r[:, None] * dr) + np.diff(axial, axis=1) / dz)
        face = field[:, -1] + 0.5 * dz * enters / local[:, -1]
        highest = max(highest, float(face.max()))
    return r, face, highest


def steel_conductivity(kelvin: np.ndarray) -> np.ndarray:
    """EN 1993-1-2, 3.4.1.3: conductivity (W/(m.K)) of carbon steel."""
    celsius = kelvin - 273.15
    return np.where(celsius < 800.0, 54.0 - 3.33e-2 * celsius, 27.3)


def steel_capacity(kelvin: np.ndarray) -> np.ndarray:
    """EN 1993-1-2, 3.4.1.2: heat capacity (J/(m3.K)) of carbon steel below 735 degC, at 7,850 kg/m3."""
    celsius = kelvin - 273.15
    low = 425.0 + 0.773 * celsius - 1.69e-3 * celsius**2 + 2.22e-6 * celsius**3
    return 7850.0 * np.where(celsius < 600.0, low, 666.0 + 13002.0 / (738.0 - np.minimum(celsius, 735.0)))


def moving_source(
    length: float,
    height: float,
    contact: float,
    speed: float,
    flux: float,
    duration: float,
    conductivity: Callable[[np.ndarray], np.ndarray],
    capacity: Callable[[np.ndarray], np.ndarray],
    start: float,
    every: float,
    cells: int = 100,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Closed strip under a contact that slides round it and heats it by `flux` (W/m2), insulated elsewhere, with the properties of the
    local temperature: times, mean temperature, mean and highest of the face in the contact (K).

    Plane finite volumes fixed to the strip; the contact moves by a cell in a step. Crank and Nicolson's scheme in depth on layers that
    grow by 15 % from 40 µm on, explicit along the strip, enthalpy conserved up to the iteration: two rounds.
    """
    width = length / cells
    step, covered = width / speed, round(contact / width)
    layers = [4e-5]
    while sum(layers) < height:
        layers.append(1.15 * layers[-1])
    layer = np.array(layers)[:, None] * height / sum(layers)
    gap = 0.5 * (layer[1:] + layer[:-1])
    kelvin = np.linspace(start, start + 1000.0, 10001)
    stored = np.concatenate(([0.0], np.cumsum(0.05 * (capacity(kelvin)[1:] + capacity(kelvin)[:-1]))))
    field, found = np.full((layer.size, cells), start), []
    for index in range(round(duration / step)):
        heated = (index + np.arange(covered + 1)) % cells
        taken = np.zeros(cells)
        taken[heated] = flux
        taken[heated[[0, -1]]] *= 0.5
        local = conductivity(field)
        along = -0.5 * (local + np.roll(local, -1, 1)) * (np.roll(field, -1, 1) - field) / width
        source = (np.roll(along, 1, 1) - along) * layer / width
        source[0] += taken
        before, ahead = np.interp(field, kelvin, stored), field
        for _ in range(2):
            change = np.where(ahead == field, 1.0, ahead - field)
            secant = np.where(ahead == field, capacity(field), (np.interp(ahead, kelvin, stored) - before) / change)
            middle = conductivity(0.5 * (field + ahead))
            half = 0.25 * (middle[1:] + middle[:-1]) / gap
            explicit = np.zeros_like(field)
            explicit[:-1] += half * np.diff(field, axis=0)
            explicit[1:] -= half * np.diff(field, axis=0)
            ahead = field + tridiagonal(secant * layer / step, half, source + 2.0 * explicit)
        field = ahead
        if (index + 1) % round(every / step) == 0:
            under = (index + 1 + np.arange(covered)) % cells
            face = field[0, under] + 0.5 * layer[0] * flux / conductivity(field[0, under])
            found.append(((index + 1) * step, float((field * layer).sum()) / (height * cells), face.mean(), face.max()))
    times, mean, average, highest = np.array(found).T
    return times, mean, average, highest


def tridiagonal(diagonal: np.ndarray, couplings: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Columns x with (diagonal + sum of the row's couplings) x - couplings times the neighbours = right: Thomas's algorithm."""
    size = len(diagonal)
    upper, values = np.zeros_like(diagonal), np.zeros_like(right)
    for row in range(size):
        pivot = diagonal[row] + (couplings[row] if row + 1 < size else 0.0)
        known = right[row]
        if row > 0:
            pivot = pivot + couplings[row - 1] * (1.0 - upper[row - 1])
            known = known + couplings[row - 1] * values[row - 1]
        upper[row] = couplings[row] / pivot if row + 1 < size else 0.0
        values[row] = known / pivot
    for row in range(size - 2, -1, -1):
        values[row] += upper[row] * values[row + 1]
    return values


def brake_emission(speed: np.ndarray) -> np.ndarray:
    """EMEP/EEA: PM10 (mg/km) from the brakes of a car over its mean speed (km/h)."""
    factor = np.where(speed < 40.0, 1.67, np.where(speed > 95.0, 0.185, 2.75 - 0.027 * speed))
    return 7.5 * 0.98 * factor


def repeated_stops(rise: float, exponent: float, count: np.ndarray) -> np.ndarray:
    """Rise (K) of a uniform disc after every stop: a geometric series in exp(-`exponent`), h A t / (rho c V)."""
    return rise * (1.0 - np.exp(-exponent * count)) / (1.0 - np.exp(-exponent))


def sliding_punch(x: np.ndarray, friction: float, poisson: float) -> np.ndarray:
    """Pressure over its mean under a rigid flat punch that slides on a half-plane; `x` over the half-width, towards +1."""
    eta = np.arctan(friction * (1.0 - 2.0 * poisson) / (2.0 * (1.0 - poisson))) / np.pi
    return 2.0 * np.cos(np.pi * eta) / (np.pi * np.sqrt(1.0 - x**2)) * ((1.0 + x) / (1.0 - x)) ** (-eta)


def worn_flat_punch(x: np.ndarray, tau: float, order: int = 80) -> np.ndarray:
    """Pressure over its mean under a flat punch on a half-plane after `tau` = k s E*/a of wear.

    Series over the eigenfunctions of the logarithmic kernel, by Galerkin's method in Legendre polynomials; it starts from
    the pressure of the unworn punch, 2/(pi sqrt(1 - x^2)).
    """
    # On T_n/sqrt(1-x^2) the kernel -2/pi ln|x-t| is diagonal: 2 ln 2 (n = 0), 2/n. Legendre's P_i enters through its
    # integrals against T_n.
    many = 4 * order
    nodes = np.cos((np.arange(many) + 0.5) * np.pi / many)
    polynomials = legendre.legvander(nodes, order)[:, 1:]
    weighted = polynomials * np.sqrt(1.0 - nodes**2)[:, None]
    cosines = chebyshev.chebvander(nodes, many - 1)
    # Expansion of P_i sqrt(1-x^2), which is P_i as a density over the weight 1/sqrt(1-x^2).
    coefficients = 2.0 / many * cosines.T @ weighted
    eigenvalues = np.concatenate(([2.0 * np.log(2.0)], 2.0 / np.arange(1, many)))
    coefficients[0] /= 2.0
    norms = np.concatenate(([np.pi], np.full(many - 1, np.pi / 2.0)))
    kernel = coefficients.T @ (coefficients * (eigenvalues * norms)[:, None])
    mass = 2.0 / (2.0 * np.arange(1, order + 1) + 1.0)
    scale = 1.0 / np.sqrt(mass)
    values, vectors = np.linalg.eigh(kernel * np.outer(scale, scale))
    # Start: moments of 2/(pi sqrt(1-x^2)) with the orthonormal polynomials.
    start = scale * (2.0 / many) * polynomials.sum(axis=0)
    decayed = vectors @ (np.exp(-tau / values) * (vectors.T @ start))
    return 1.0 + legendre.legvander(x, order)[:, 1:] @ (scale * decayed)


def band_source(peclet: float, x: np.ndarray, count: int = 800) -> np.ndarray:
    """T K/(q l) under a band of half-width l that moves towards +1; `x` over l. Jaeger's integral of K0."""
    integral = source_integral(peclet * np.linspace(-2.0, 2.0, count + 1))
    at = np.interp(peclet * (x + 1.0), peclet * np.linspace(-2.0, 2.0, count + 1), integral)
    return (at - np.interp(peclet * (x - 1.0), peclet * np.linspace(-2.0, 2.0, count + 1), integral)) / (np.pi * peclet)


def source_integral(u: np.ndarray) -> np.ndarray:
    """Integral of exp(-s) K0(|s|) from 0 to `u`, by K0(s) = integral of exp(-s cosh t) over t > 0."""
    t, weight = gauss(0.0, 12.0, 120)
    cosh = np.cosh(t)
    rate = np.where(u[:, None] >= 0.0, cosh + 1.0, cosh - 1.0 + 1e-300)
    reach = np.abs(u)[:, None]
    part = np.where(rate * reach > 1e-8, -np.expm1(-rate * reach) / rate, reach)
    return np.sign(u) * (part @ weight)


def gauss(low: float, high: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = legendre.leggauss(count)
    return low + 0.5 * (high - low) * (nodes + 1.0), 0.5 * (high - low) * weights


def flash_maximum(peclet: ArrayLike) -> ArrayLike:
    """Tian and Kennedy: highest T K/(q l) of a square uniform source of half-side l."""
    return 2.0 / np.sqrt(np.pi * (1.011 + peclet))


def flash_mean(peclet: ArrayLike) -> ArrayLike:
    """Tian and Kennedy: mean T K/(q r) of a circular uniform source of radius r."""
    return 1.22 / np.sqrt(np.pi * (0.6575 + peclet))


def worn_ball(radius: float, volume: np.ndarray) -> np.ndarray:
    """Diameter (m) of the flat on a ball that has lost the cap of this volume (m3)."""
    height = np.sqrt(volume / (np.pi * radius))
    for _ in range(50):
        height = np.sqrt(volume / (np.pi * (radius - height / 3.0)))
    return 2.0 * np.sqrt(height * (2.0 * radius - height))


def worn_cylinder(radius: float, length: float, volume: np.ndarray) -> np.ndarray:
    """Width (m) of the flat along a cylinder that has lost the segment of this volume (m3)."""
    area = volume / (length * radius**2)
    angle = np.cbrt(1.5 * area)
    for _ in range(50):
        angle = angle - (angle - 0.5 * np.sin(2.0 * angle) - area) / (2.0 * np.sin(angle) ** 2)
    return 2.0 * radius * np.sin(angle)


def growth(ratio: ArrayLike) -> ArrayLike:
    """Growth rate over diffusivity times wave number squared, at `ratio` times the critical speed: Burton's insulated mate."""
    z = 0.5 * (np.sqrt(1.0 + 8.0 * np.asarray(ratio)) - 1.0)
    return z**2 - 1.0


@dataclass(frozen=True)
class Solid:
    modulus: float  # Young's, Pa
    poisson: float
    expansion: float  # 1/K
    conductivity: float  # W/(m.K)
    diffusivity: float  # m2/s

    def depth_rate(self, wave: float, speed: complex) -> complex:
        """Decay into the depth of a temperature wave that passes the material at `speed`."""
        return np.sqrt(wave**2 + 1j * wave * speed / self.diffusivity)


def half_plane(solid: Solid, wave: float, speed: complex) -> tuple[complex, complex, float]:
    """Heat taken up and lift of the free surface, each per temperature; displacement per pressure."""
    rate = solid.depth_rate(wave, speed)
    lift = 2.0 * solid.expansion * (1.0 + solid.poisson) / (rate + wave)
    return solid.conductivity * rate, lift, 2.0 * (1.0 - solid.poisson**2) / (solid.modulus * wave)


def band_speed(bodies: tuple[Solid, Solid], friction: float, wave: float, rate: float) -> float:
    """Sliding speed normal to the plane of a wave that stands in both half-planes at which it grows at `rate` (1/s)."""
    # exp(rate t) is a motion at an imaginary speed.
    parts = [half_plane(body, wave, -1j * rate / wave) for body in bodies]
    heat, lift, give = (sum(part[index] for part in parts) for index in range(3))
    return float((give * heat / (friction * lift)).real)


def band_growth(bodies: tuple[Solid, Solid], friction: float, wave: float, speed: float) -> float:
    """Its growth rate (1/s) at this speed, above the critical one."""
    low, high = 0.0, 1.0
    while band_speed(bodies, friction, wave, high) < speed:
        high *= 2.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if band_speed(bodies, friction, wave, middle) < speed else (low, middle)
    return low


def bending_layer(solid: Solid, half: float, wave: float, speed: complex) -> tuple[complex, complex, float]:
    """The same for a layer of half-thickness `half` in its antisymmetric mode."""
    rate, u = solid.depth_rate(wave, speed), wave * half
    stiffness = np.sinh(u) * np.cosh(u) - u
    depth, weight = gauss(0.0, half, 40)
    shape = np.sinh(rate * depth) / np.sinh(rate * half)
    integral = weight @ (shape * np.sinh(wave * depth))
    lift = 2.0 * solid.expansion * (1.0 + solid.poisson) * np.cosh(u) / stiffness * integral
    compliance = 2.0 * (1.0 - solid.poisson**2) / (solid.modulus * wave) * np.cosh(u) ** 2 / stiffness
    return solid.conductivity * rate / np.tanh(rate * half), lift, compliance


def disc_critical_speed(pad: Solid, disc: Solid, half: float, friction: float, wave: float) -> float:
    """Speed at which an antisymmetric wave of a disc between two pads neither grows nor decays (Lee and Barber).

    The wave drifts slowly in the disc; drift and speed are those at which the complex condition has a real speed.
    """

    def speed_of(drift: float, speed: float) -> complex:
        heat_disc, lift_disc, give_disc = bending_layer(disc, half, wave, drift)
        heat_pad, lift_pad, give_pad = half_plane(pad, wave, drift - speed)
        return (give_disc + give_pad) * (heat_disc + heat_pad) / (friction * (lift_disc + lift_pad))

    state = np.array([0.0, 10.0])
    # The wave almost rests in the disc: fixed point of the speed first, then both unknowns by Newton's method.
    for _ in range(15):
        state[1] = 0.5 * (state[1] + speed_of(0.0, state[1]).real)

    def residual(at: np.ndarray) -> np.ndarray:
        value = speed_of(at[0], at[1])
        return np.array([value.real - at[1], value.imag])

    for _ in range(60):
        now = residual(state)
        steps = 1e-6 * np.maximum(np.abs(state), 1e-3)
        jacobian = np.column_stack([(residual(state + step * unit) - now) / step for step, unit in zip(steps, np.eye(2))])
        change = np.linalg.solve(jacobian, now)
        state = state - change
        if np.abs(change).max() < 1e-10 * abs(state[1]):
            return float(state[1])
    raise ValueError(f"no critical speed found at the wave number {wave:g} 1/m")
