/* The vehicle's variables, one line each: the only list of them. C takes order and start values from here, the Python
 * script that packs the FMU writes modelDescription.xml from it. The value reference is the line's number.
 *
 *     VARIABLE(name, causality, start value, unit, description)
 */

/* Car. */
VARIABLE(mass, parameter, 1500.0, "kg", "Mass of the car with its driver")
VARIABLE(rotating_mass, parameter, 45.0, "kg", "Inertia of wheels and driveline over the wheel radius squared")
VARIABLE(wheelbase, parameter, 2.65, "m", "Distance of the axles")
VARIABLE(centre_to_rear_axle, parameter, 1.54, "m", "Horizontal distance of the centre of gravity from the rear axle")
VARIABLE(centre_height, parameter, 0.55, "m", "Height of the centre of gravity above the road")
VARIABLE(pitch_time, parameter, 0.15, "s", "Time constant with which axle loads follow the acceleration")
VARIABLE(wheel_radius, parameter, 0.31, "m", "Rolling radius of the wheels")
VARIABLE(rolling_resistance, parameter, 0.012, "1", "Rolling resistance over weight")
VARIABLE(drag_area, parameter, 0.66, "m2", "Drag coefficient times frontal area")
VARIABLE(tyre_friction, parameter, 1.0, "1", "Largest brake force over axle load; what the anti-lock control allows")
VARIABLE(drive_force_limit, parameter, 6000.0, "N", "Largest driving force at the wheels")
VARIABLE(drive_time, parameter, 0.2, "s", "Time constant of the driving force")

/* Brakes: what turns a demanded force into a pad load. */
VARIABLE(front_mean_radius, parameter, 0.1175, "m", "Mean radius of the front contacts")
VARIABLE(rear_mean_radius, parameter, 0.112, "m", "Mean radius of the rear contacts")
VARIABLE(brake_faces, parameter, 2.0, "1", "Pads of a brake")
VARIABLE(brake_friction, parameter, 0.4, "1", "Design friction coefficient of the brake; the present one is not available to the car")
VARIABLE(brake_time, parameter, 0.1, "s", "Time constant of the pad load")

/* Driver. */
VARIABLE(driver_gain, parameter, 0.8, "1/s", "Demanded acceleration per speed error")
VARIABLE(driver_integral_gain, parameter, 0.15, "1/s2", "Its rate per speed error: the foot presses harder where the brakes fade")
VARIABLE(stop_time, parameter, 1e9, "s", "Time from which the pedal demands stop_deceleration, without feedback")
VARIABLE(stop_deceleration, parameter, 8.0, "m/s2", "Deceleration that this pedal gives on a level road with cold brakes")
VARIABLE(hold_reserve, parameter, 2.0, "1", "At rest the driver presses this many times what holds the car on its grade")
VARIABLE(initial_speed, parameter, 0.0, "m/s", "Speed at the start")

/* From the contacts: with these two the car locks itself at standstill. */
VARIABLE(front_left_kinetic_force, input, 0.0, "N", "friction_force_kinetic of the front left brake")
VARIABLE(front_right_kinetic_force, input, 0.0, "N", "friction_force_kinetic of the front right brake")
VARIABLE(rear_left_kinetic_force, input, 0.0, "N", "friction_force_kinetic of the rear left brake")
VARIABLE(rear_right_kinetic_force, input, 0.0, "N", "friction_force_kinetic of the rear right brake")
VARIABLE(front_left_limit_force, input, 0.0, "N", "friction_force_limit of the front left brake")
VARIABLE(front_right_limit_force, input, 0.0, "N", "friction_force_limit of the front right brake")
VARIABLE(rear_left_limit_force, input, 0.0, "N", "friction_force_limit of the rear left brake")
VARIABLE(rear_right_limit_force, input, 0.0, "N", "friction_force_limit of the rear right brake")

/* To the contacts. */
VARIABLE(front_sliding_velocity, output, 0.0, "m/s", "Speed of the front discs under their pads")
VARIABLE(rear_sliding_velocity, output, 0.0, "m/s", "Speed of the rear discs under their pads")
VARIABLE(front_normal_load, output, 0.0, "N", "Load of each front pad")
VARIABLE(rear_normal_load, output, 0.0, "N", "Load of each rear pad")

/* To look at. */
VARIABLE(position, output, 0.0, "m", "Distance driven")
VARIABLE(speed, output, 0.0, "m/s", "Speed of the car")
VARIABLE(reference_speed, output, 0.0, "m/s", "Speed that the driver aims at")
VARIABLE(acceleration, output, 0.0, "m/s2", "Rate of the speed")
VARIABLE(grade, output, 0.0, "1", "Rise over horizontal distance of the road under the car")
VARIABLE(drive_force, output, 0.0, "N", "Driving force at the wheels")
VARIABLE(brake_demand, output, 0.0, "N", "Brake force demanded by the pedal")
VARIABLE(front_brake_force, output, 0.0, "N", "Brake force of the front axle at the tyres; at standstill what it could give while sliding")
VARIABLE(rear_brake_force, output, 0.0, "N", "Brake force of the rear axle at the tyres; at standstill what it could give while sliding")
VARIABLE(brake_work, output, 0.0, "J", "Work of the four brakes, as the car reckons it")
VARIABLE(side_difference, output, 0.0, "N", "Brake force of the left side less that of the right side")
VARIABLE(front_axle_load, output, 0.0, "N", "Load of the front axle")
VARIABLE(rear_axle_load, output, 0.0, "N", "Load of the rear axle")
VARIABLE(is_locked, output, 0.0, "1", "1 where the car stands and the brakes can hold it, else 0")
