/* Longitudinal dynamics of a car with its driver; see vehicle.c. */
#ifndef VEHICLE_H
#define VEHICLE_H

#include <stddef.h>

/* Value references, in the order of variables.h. */
enum {
#define VARIABLE(name, causality, start, unit, description) VEHICLE_##name,
#include "variables.h"
#undef VARIABLE
    VEHICLE_COUNT,
    VEHICLE_FIRST_INPUT = VEHICLE_front_left_kinetic_force,
    VEHICLE_LAST_INPUT = VEHICLE_rear_right_limit_force
};

/* A polyline: x increases; constant outside. */
typedef struct {
    size_t count;
    double *x, *y;
} Table;

/* All that changes while driving: copied whole to save and restore. */
typedef struct {
    double value[VEHICLE_COUNT];
    double rate[VEHICLE_COUNT]; /* of inputs, per second, for the next step only */
    double time;
    double integral;            /* m/s2, of the driver's speed error */
    double locked;              /* 1 or 0 */
    double specific_force;      /* m/s2, acceleration plus that of gravity along the road, filtered: pitch */
} VehicleState;

void vehicle_start_values(VehicleState *state);
/* Sets the states from the parameters and computes the outputs. */
void vehicle_initialise(VehicleState *state, const Table *speed, const Table *grade, double time);
void vehicle_outputs(VehicleState *state, const Table *speed, const Table *grade);
/* Moves on by `step` (s) with the inputs going on at their rates, which are 0 again afterwards. */
void vehicle_step(VehicleState *state, const Table *speed, const Table *grade, double step);
/* Reads a CSV file of two columns under one line of headings. Returns 0, or 1 where there is no such table. */
int table_read(Table *table, const char *path);
void table_free(Table *table);

#endif
