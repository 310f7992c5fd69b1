import time

import numpy as np
import RPi.GPIO as GPIO
import serial
import skfuzzy as fuzz
from skfuzzy import control as ctrl

PIN = 18
GPIO.setmode(GPIO.BCM)
GPIO.setup(PIN, GPIO.OUT)
pwm = GPIO.PWM(PIN, 100)
pwm.start(0)
port = serial.Serial("/dev/ttyUSB0", 9600, timeout=1)

temperature = ctrl.Antecedent(np.arange(0, 51, 1), "temperature")
duty = ctrl.Consequent(np.arange(0, 101, 1), "duty")
temperature["low"] = fuzz.trapmf(temperature.universe, [0, 0, 15, 22])
temperature["right"] = fuzz.trimf(temperature.universe, [18, 24, 30])
temperature["high"] = fuzz.trapmf(temperature.universe, [26, 33, 50, 50])
duty["off"] = fuzz.trimf(duty.universe, [0, 0, 20])
duty["half"] = fuzz.trimf(duty.universe, [20, 50, 80])
duty["full"] = fuzz.trimf(duty.universe, [70, 100, 100])
vent = ctrl.ControlSystemSimulation(ctrl.ControlSystem([
    ctrl.Rule(temperature["low"], duty["off"]),
    ctrl.Rule(temperature["right"], duty["half"]),
    ctrl.Rule(temperature["high"], duty["full"]),
]))
try:
    while True:
        line = port.readline().decode().strip()
        try:
            vent.input["temperature"] = float(line)
        except serial.SerialException:
            continue
        vent.compute()
        pwm.ChangeDutyCycle(vent.output["duty"])
        time.sleep(2)
except KeyboardInterrupt:
    GPIO.cleanup()
