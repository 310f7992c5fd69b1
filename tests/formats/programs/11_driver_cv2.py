import cv2
import dlib
import numpy as np
import skfuzzy as fuzz
from imutils import face_utils
from skfuzzy import control as ctrl

eyes = ctrl.Antecedent(np.arange(0, 1.01, 0.01), "eyes")
yawns = ctrl.Antecedent(np.arange(0, 11, 1), "yawns")
tired = ctrl.Consequent(np.arange(0, 101, 1), "tired")
eyes["closed"] = fuzz.trimf(eyes.universe, [0, 0, 0.4])
eyes["open"] = fuzz.trimf(eyes.universe, [0.2, 1, 1])
yawns["few"] = fuzz.trimf(yawns.universe, [0, 0, 5])
yawns["many"] = fuzz.trimf(yawns.universe, [3, 10, 10])
tired["no"] = fuzz.trimf(tired.universe, [0, 0, 50])
tired["yes"] = fuzz.trimf(tired.universe, [40, 100, 100])
alarm = ctrl.ControlSystemSimulation(ctrl.ControlSystem([
    ctrl.Rule(eyes["closed"] | yawns["many"], tired["yes"]),
    ctrl.Rule(eyes["open"] & yawns["few"], tired["no"]),
]))
detector = dlib.get_frontal_face_detector()
(start, end) = face_utils.FACIAL_LANDMARKS_IDXS["left_eye"]
camera = cv2.VideoCapture(0)
while camera.isOpened():
    ok, frame = camera.read()
    grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    for face in detector(grey):
        alarm.input["eyes"] = 0.3
        alarm.input["yawns"] = 2
        alarm.compute()
        cv2.putText(frame, str(alarm.output["tired"]), (10, 30), 0, 1, (0, 0, 255))
    if cv2.waitKey(1) & 0xFF == ord("q"):
        break
camera.release()
