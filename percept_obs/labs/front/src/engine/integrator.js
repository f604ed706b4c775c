// Printed by percept_obs/compile/integrator.py, which says what they mean.
export const COUPLING = [[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
export const WEIGHTS = [0.16666666666666666, 0.3333333333333333, 0.3333333333333333, 0.16666666666666666];
export const INSTANTS = [0.0, 0.5, 1.0];
export const PLACES = [0, 1, 1, 2];
export const LONGEST_STEP = 0.01;
export const PLANT_STEP = 0.0025;
export const STEP_ROUNDING = 0.0001;
export const LARGEST_SQUARED_STATE = 1e+300;
