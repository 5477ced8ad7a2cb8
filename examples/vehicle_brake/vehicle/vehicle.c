/* Longitudinal dynamics of a car with its driver.
 *
 *     (m + m_rot) dv/dt = drive - m g sin(beta) - rho c_d A v |v|/2 - sgn(v) (R + sum_i F_i r_i/r_w)
 *
 * beta: slope of the road, R: rolling resistance, F_i: friction force of brake i, r_i: its mean radius, r_w: wheel
 * radius. Wheels roll without slip. The contacts give the magnitude F_i while sliding (friction_force_kinetic) and the
 * most that they hold at rest (friction_force_limit); the sign is the car's own business, and so is standing still:
 * at v = 0 the car is locked as long as the other forces do not exceed R + sum_i F_limit,i r_i/r_w. Nothing creeps, at
 * any step size, and no stiff friction law stands in the loop.
 *
 * Axle loads (a: acceleration plus gravity along the road, filtered by the pitch of the body; h: height of the centre of
 * gravity; l: wheelbase, b: distance from the rear axle):
 *
 *     N_front = m (g cos(beta) b - a h)/l,    N_rear = m g cos(beta) - N_front
 *
 * The brakes are distributed in proportion to them, each axle at most up to the grip of its tyres.
 */
#include "vehicle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define GRAVITY 9.80665      /* m/s2 */
#define AIR_DENSITY 1.2      /* kg/m3, dry air at 20 degC and sea level */
#define LONGEST_STEP 1e-3    /* s: a hundredth of the fastest lag */
#define WALKING_SPEED 0.3    /* m/s: below, with a reference of 0, the driver holds instead of steering the speed */
#define HELD_GRADE 0.03      /* at least what holds the creep of an automatic transmission, over the weight */

static double table_at(const Table *table, double x)
{
    size_t low = 0, high = table->count - 1;
    if (x <= table->x[0]) return table->y[0];
    if (x >= table->x[high]) return table->y[high];
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (table->x[middle] <= x) low = middle; else high = middle;
    }
    return table->y[low] + (table->y[high] - table->y[low]) * (x - table->x[low]) / (table->x[high] - table->x[low]);
}

int table_read(Table *table, const char *path)
{
    FILE *file = fopen(path, "r");
    char line[256];
    size_t room = 0;
    table->count = 0;
    table->x = table->y = NULL;
    if (file == NULL) return 1;
    if (fgets(line, sizeof line, file) == NULL) line[0] = 0; /* headings */
    while (fgets(line, sizeof line, file) != NULL) {
        double x, y;
        char *end, *last;
        x = strtod(line, &end);
        if (end == line || *end != ',') break;
        y = strtod(end + 1, &last);
        if (last == end + 1 || !isfinite(x) || !isfinite(y)) break;
        if (table->count > 0 && !(x > table->x[table->count - 1])) {
            table->count = 0;
            break;
        }
        if (table->count == room) {
            double *grown;
            room = room == 0 ? 256 : 2 * room;
            grown = realloc(table->x, room * sizeof *grown);
            if (grown == NULL) { table->count = 0; break; }
            table->x = grown;
            grown = realloc(table->y, room * sizeof *grown);
            if (grown == NULL) { table->count = 0; break; }
            table->y = grown;
        }
        table->x[table->count] = x;
        table->y[table->count++] = y;
    }
    if (!feof(file)) table->count = 0;
    fclose(file);
    return table->count == 0;
}

void table_free(Table *table)
{
    free(table->x);
    free(table->y);
    table->x = table->y = NULL;
    table->count = 0;
}

void vehicle_start_values(VehicleState *state)
{
    static const double start[VEHICLE_COUNT] = {
#define VARIABLE(name, causality, start, unit, description) start,
#include "variables.h"
#undef VARIABLE
    };
    int i;
    for (i = 0; i < VEHICLE_COUNT; ++i) {
        state->value[i] = start[i];
        state->rate[i] = 0.0;
    }
    state->time = state->integral = state->locked = state->specific_force = 0.0;
}

#define OF(name) (state->value[VEHICLE_##name])

/* Forces of the four brakes at the tyres, N: while sliding, or the most at rest. */
typedef struct {
    double front_left, front_right, rear_left, rear_right;
} Forces;

/* Value of an input `since` the beginning of the step (s); friction forces are magnitudes. */
#define INPUT(name) fmax(OF(name) + since * state->rate[VEHICLE_##name], 0.0)

static Forces at_tyres(double fl, double fr, double rl, double rr, const VehicleState *state)
{
    const double front = OF(front_mean_radius) / OF(wheel_radius), rear = OF(rear_mean_radius) / OF(wheel_radius);
    const Forces forces = {fl * front, fr * front, rl * rear, rr * rear};
    return forces;
}

static double total(Forces forces)
{
    return forces.front_left + forces.front_right + forces.rear_left + forces.rear_right;
}

static Forces sliding_forces(const VehicleState *state, double since)
{
    return at_tyres(INPUT(front_left_kinetic_force), INPUT(front_right_kinetic_force), INPUT(rear_left_kinetic_force),
                    INPUT(rear_right_kinetic_force), state);
}

static Forces holding_forces(const VehicleState *state, double since)
{
    return at_tyres(INPUT(front_left_limit_force), INPUT(front_right_limit_force), INPUT(rear_left_limit_force),
                    INPUT(rear_right_limit_force), state);
}

static double slope_at(const VehicleState *state, const Table *grade)
{
    return atan(table_at(grade, OF(position)));
}

static void axle_loads(VehicleState *state, double slope)
{
    const double weight = OF(mass) * GRAVITY * cos(slope);
    const double shift = OF(mass) * state->specific_force * OF(centre_height);
    OF(front_axle_load) = (weight * OF(centre_to_rear_axle) - shift) / OF(wheelbase);
    OF(rear_axle_load) = weight - OF(front_axle_load);
}

/* Forces along the road that do not come from friction, N. */
static double free_force(const VehicleState *state, double slope)
{
    return OF(drive_force) - OF(mass) * GRAVITY * sin(slope)
         - 0.5 * AIR_DENSITY * OF(drag_area) * OF(speed) * fabs(OF(speed));
}

static double rolling(const VehicleState *state, double slope)
{
    return OF(mass) * GRAVITY * cos(slope) * OF(rolling_resistance);
}

static double inertia(const VehicleState *state)
{
    return OF(mass) + OF(rotating_mass);
}

/* Drive force and pad loads that driver and brake system ask for. */
static void demands(VehicleState *state, const Table *speed, double slope, double step, double *drive, double *front,
                    double *rear)
{
    const double ahead = 0.5;
    const double wanted = table_at(speed, state->time);
    const double rate = (table_at(speed, state->time + ahead) - table_at(speed, state->time - ahead)) / (2.0 * ahead);
    const double error = wanted - OF(speed);
    double force, share, grip_front, grip_rear, per_load;

    if (state->time >= OF(stop_time)) {
        force = -inertia(state) * OF(stop_deceleration);
    } else if (wanted == 0.0 && rate == 0.0 && fabs(OF(speed)) < WALKING_SPEED) {
        const double weight = OF(mass) * GRAVITY;
        force = -weight * fmax(OF(hold_reserve) * fabs(sin(slope)), HELD_GRADE);
        state->integral = 0.0;
    } else {
        const double resistance = rolling(state, slope) * (OF(speed) > 0.0 ? 1.0 : 0.0) - (free_force(state, slope) - OF(drive_force));
        const double proportional = rate + OF(driver_gain) * error;
        force = inertia(state) * (proportional + state->integral) + resistance;
        /* The integral stands still where the engine can give no more. */
        if (!(force > OF(drive_force_limit) && error > 0.0)) state->integral += OF(driver_integral_gain) * error * step;
    }
    *drive = fmin(fmax(force, 0.0), OF(drive_force_limit));
    OF(brake_demand) = fmax(-force, 0.0);
    axle_loads(state, slope);
    share = OF(front_axle_load) / (OF(front_axle_load) + OF(rear_axle_load));
    grip_front = OF(tyre_friction) * fmax(OF(front_axle_load), 0.0);
    grip_rear = OF(tyre_friction) * fmax(OF(rear_axle_load), 0.0);
    /* Two brakes on an axle. */
    per_load = 2.0 * OF(brake_faces) * OF(brake_friction) / OF(wheel_radius);
    *front = fmin(share * OF(brake_demand), grip_front) / (per_load * OF(front_mean_radius));
    *rear = fmin((1.0 - share) * OF(brake_demand), grip_rear) / (per_load * OF(rear_mean_radius));
}

void vehicle_initialise(VehicleState *state, const Table *speed, const Table *grade, double time)
{
    double drive, front, rear;
    state->time = time;
    state->integral = state->specific_force = 0.0;
    OF(position) = 0.0;
    OF(speed) = OF(initial_speed);
    OF(acceleration) = OF(drive_force) = OF(brake_work) = 0.0;
    /* What is asked for at the start is there at the start. */
    demands(state, speed, slope_at(state, grade), 0.0, &drive, &front, &rear);
    OF(drive_force) = drive;
    OF(front_normal_load) = front;
    OF(rear_normal_load) = rear;
    state->locked = OF(speed) == 0.0;
    vehicle_outputs(state, speed, grade);
}

void vehicle_outputs(VehicleState *state, const Table *speed, const Table *grade)
{
    const Forces forces = sliding_forces(state, 0.0);
    axle_loads(state, slope_at(state, grade));
    OF(front_sliding_velocity) = OF(speed) * OF(front_mean_radius) / OF(wheel_radius);
    OF(rear_sliding_velocity) = OF(speed) * OF(rear_mean_radius) / OF(wheel_radius);
    OF(front_brake_force) = forces.front_left + forces.front_right;
    OF(rear_brake_force) = forces.rear_left + forces.rear_right;
    OF(side_difference) = forces.front_left + forces.rear_left - forces.front_right - forces.rear_right;
    OF(reference_speed) = table_at(speed, state->time);
    OF(grade) = table_at(grade, OF(position));
    OF(is_locked) = state->locked;
}

/* One step of speed and position, with the forces of its middle, `since` the inputs were set (s); the moment of stopping
 * is located. */
static void move(VehicleState *state, double slope, double since, double step)
{
    const double mass = inertia(state);
    const double other = free_force(state, slope);
    const double brakes = total(sliding_forces(state, since));
    const double sliding = brakes + rolling(state, slope);
    const double holding = total(holding_forces(state, since)) + rolling(state, slope);
    double left = step;
    const double before = OF(speed), from = OF(position);

    if (OF(speed) != 0.0) {
        const double rate = (other - copysign(sliding, OF(speed))) / mass;
        const double next = OF(speed) + rate * step;
        if (next * OF(speed) > 0.0) {
            OF(position) += 0.5 * (OF(speed) + next) * step;
            OF(speed) = next;
            left = 0.0;
        } else {
            const double until = -OF(speed) / rate;
            OF(position) += 0.5 * OF(speed) * until;
            OF(speed) = 0.0;
            left -= until;
        }
    }
    state->locked = OF(speed) == 0.0 && fabs(other) <= holding;
    if (left > 0.0 && !state->locked) {
        /* The rest of the step from rest. Where the limit is exceeded and the sliding force is not (it is the lower of
         * both), the car moves off. */
        const double rate = (other - copysign(fmin(sliding, fabs(other)), other)) / mass;
        OF(position) += 0.5 * rate * left * left;
        OF(speed) = rate * left;
    }
    OF(brake_work) += brakes * fabs(OF(position) - from);
    OF(acceleration) = (OF(speed) - before) / step;
}

void vehicle_step(VehicleState *state, const Table *speed, const Table *grade, double step)
{
    const int count = (int)ceil(step / LONGEST_STEP - 1e-6);
    const double start = state->time, h = step / (count > 0 ? count : 1);
    int i;
    for (i = 0; i < count; ++i) {
        const double slope = slope_at(state, grade);
        double drive, front, rear;
        demands(state, speed, slope, h, &drive, &front, &rear);
        /* Lags, exact for demands held over the step. */
        OF(drive_force) = drive + (OF(drive_force) - drive) * exp(-h / OF(drive_time));
        OF(front_normal_load) = front + (OF(front_normal_load) - front) * exp(-h / OF(brake_time));
        OF(rear_normal_load) = rear + (OF(rear_normal_load) - rear) * exp(-h / OF(brake_time));
        move(state, slope, (i + 0.5) * h, h);
        {
            const double felt = OF(acceleration) + GRAVITY * sin(slope);
            state->specific_force = felt + (state->specific_force - felt) * exp(-h / OF(pitch_time));
        }
        state->time = start + (i + 1) * h;
    }
    state->time = start + step;
    for (i = 0; i < VEHICLE_COUNT; ++i) state->rate[i] = 0.0;
    vehicle_outputs(state, speed, grade);
}
