import numpy as np
import skfuzzy as fuzz
from flask import Flask, jsonify, request
from skfuzzy import control as ctrl

app = Flask(__name__)


def build_system():
    soil = ctrl.Antecedent(np.arange(0, 101, 1), "soil")
    sun = ctrl.Antecedent(np.arange(0, 13, 0.5), "sun")
    water = ctrl.Consequent(np.arange(0, 31, 1), "water")
    soil["dry"] = fuzz.trapmf(soil.universe, [0, 0, 20, 45])
    soil["moist"] = fuzz.trimf(soil.universe, [30, 50, 70])
    soil["wet"] = fuzz.trapmf(soil.universe, [55, 80, 100, 100])
    sun.automf(3)
    water.automf(3)
    return ctrl.ControlSystem([
        ctrl.Rule(soil["dry"] & sun["good"], water["good"]),
        ctrl.Rule(soil["dry"] & ~sun["good"], water["average"]),
        ctrl.Rule(soil["moist"], water["average"]),
        ctrl.Rule(soil["wet"], water["poor"]),
    ])


irrigation = ctrl.ControlSystemSimulation(build_system())


@app.route("/water", methods=["POST"])
def water():
    data = request.get_json()
    irrigation.input["soil"] = float(data["soil"])
    irrigation.input["sun"] = float(data["sun"])
    irrigation.compute()
    return jsonify(water=irrigation.output["water"])


if __name__ == "__main__":
    app.run(host="0.0.0.0", port=5000, debug=True)
