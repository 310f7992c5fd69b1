import numpy as np
import skfuzzy as fuzz

x = np.arange(0, 11, 1)
tip = np.arange(0, 26, 1)
low = fuzz.trimf(x, [0, 0, 5])
high = fuzz.trimf(x, [5, 10, 10])
small = fuzz.trimf(tip, [0, 0, 13])
big = fuzz.trimf(tip, [13, 25, 25])
level_low = fuzz.interp_membership(x, low, 6.5)
level_high = fuzz.interp_membership(x, high, 6.5)
activation_small = np.fmin(level_low, small)
activation_big = np.fmin(level_high, big)
aggregated = np.fmax(activation_small, activation_big)
print(fuzz.defuzz(tip, aggregated, "centroid"))
