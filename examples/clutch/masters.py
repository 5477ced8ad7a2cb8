"""Two masters for one loop: torque changes the slip, the slip changes the torque.

Both hold the slip over a step of the contact. `explicit_step` uses the torque of the beginning, as masters without
iteration do. `ImplicitMaster` finds the slip at the end of the step with the torque that it brings about,

    R(w) = w - w_n - h drive + h T(w)/J = 0,

by Newton's method. The torque is available in two ways: by direct feedthrough, with the states of the contact frozen (set
the slip, get the torque), and at the end of a step, which is undone where it was not the last (fmi2GetFMUstate,
fmi2SetFMUstate). The derivative is that of fmi2GetDirectionalDerivative, with the states frozen too. The equation is first
solved with frozen states, where an evaluation costs two calls and the corner of the friction law at zero slip may take a few
of them. The change of the states within the step, by heat that changes friction, is small, so Newton's method over steps of
the contact starts close to its solution.
"""

TOLERANCE = 1e-6  # imbalance of the torque that ends the iteration, over its scale
MOST_ITERATIONS = 20  # steps of the contact in one step of the master
MOST_EVALUATIONS = 100  # evaluations with the states held


class DidNotConverge(Exception):
    """The implicit master did not find the slip."""


def explicit_step(plant, contact, slip, load, step):
    """One step; returns the new slip [rad/s] and the torque used [N m]."""
    torque = contact.torque()
    slip += step * (plant.drive - torque / plant.slip_inertia)
    contact.set(slip, load)
    contact.step(step)
    return slip, torque


class Newton:
    """Newton's method for R = 0 with R(0) and R(target) of opposite signs, kept within the bracket: friction has the
    sign of the slip, so the slip ends between none and what it were without friction."""

    def __init__(self, target):
        self.low, self.high = min(0.0, target), max(0.0, target)

    def next(self, guess, residual, slope):
        if residual > 0.0:
            self.high = min(self.high, guess)
        else:
            self.low = max(self.low, guess)
        following = guess - residual / slope
        # Where Newton leaves the bracket, or friction falls so steeply with speed that R does too, halve it.
        if slope > 0.0 and self.low <= following <= self.high:
            return following
        return 0.5 * (self.low + self.high)


class ImplicitMaster:
    """Implicit Euler for the slip. `scale` [N m]: what imbalance of the torque is measured by."""

    def __init__(self, plant, contact, scale):
        self.plant, self.contact, self.scale = plant, contact, scale
        self.iterations = []  # steps of the contact in each step
        self.evaluations = []  # evaluations with the states held in each step

    def residual(self, slip, target, step):
        """Residual R at the present state of the contact, and the torque."""
        torque = self.contact.torque()
        return slip - target + step * torque / self.plant.slip_inertia, torque

    def slope(self, step):
        """dR/dw."""
        return 1.0 + step * self.contact.torque_slope() / self.plant.slip_inertia

    def is_balanced(self, residual, step):
        return abs(residual) * self.plant.slip_inertia / step <= TOLERANCE * self.scale

    def predict(self, slip, target, load, step):
        """Slip that solves R = 0 with the contact's states held."""
        newton, guess = Newton(target), min(max(slip, min(0.0, target)), max(0.0, target))
        for evaluation in range(1, MOST_EVALUATIONS + 1):
            self.contact.set(guess, load)
            residual, _ = self.residual(guess, target, step)
            if self.is_balanced(residual, step):
                break
            guess = newton.next(guess, residual, self.slope(step))
        self.evaluations.append(evaluation)
        return guess

    def step(self, slip, load, step):
        """One step; returns the new slip [rad/s] and the torque [N m]."""
        target = slip + step * self.plant.drive
        self.contact.save()
        newton, guess = Newton(target), self.predict(slip, target, load, step)
        for iteration in range(1, MOST_ITERATIONS + 1):
            if iteration > 1:
                self.contact.restore()
            self.contact.set(guess, load)
            self.contact.step(step)
            residual, torque = self.residual(guess, target, step)
            if self.is_balanced(residual, step):
                self.iterations.append(iteration)
                return guess, torque
            guess = newton.next(guess, residual, self.slope(step))
        raise DidNotConverge(
            f"after {MOST_ITERATIONS} iterations at {self.contact.time:.6g} s the slip is between "
            f"{newton.low:.6g} and {newton.high:.6g} rad/s"
        )
