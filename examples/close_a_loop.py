"""Write a rule base, check it, and close a loop around a plant of your own: a warm room.

The plant is four lines at the bottom; nothing here knows of the robot arm.
"""

from fuzzyarm.inference import compiled
from fuzzyarm.language import parse
from fuzzyarm.table import compile_table

RULES = """
rulebase heater "power from temperature error and its rate"

input  error  -4 .. 4    "set point minus room, K"
input  rate   -1 .. 1    "change of the error, K per minute"
output power  0 .. 2000  "W"

terms error: triangles HOT WARM GOOD COOL COLD
terms rate: triangles FALLING STEADY RISING
terms power: triangles OFF LOW HALF HIGH FULL

inference and min, implication min, aggregation max, defuzzifier centroid exact

rules power
  error \\ rate  FALLING  STEADY  RISING
  HOT           OFF      OFF     OFF
  WARM          OFF      OFF     LOW
  GOOD          LOW      HALF    HIGH
  COOL          HALF     HIGH    FULL
  COLD          HIGH     FULL    FULL
"""

parsed = parse(RULES, "heater")
for finding in parsed.diagnostics:  # every mistake of the text, with its place
    print(finding)
assert parsed.rulebase is not None
heater = compiled(parsed.rulebase)  # made once, evaluated many times
table = compile_table(parsed.rulebase, levels=17)  # what a small processor would run

for name, control in (
    ("rules", lambda error, rate: heater(error=error, rate=rate)["power"]),
    ("table", table.lookup),
):
    room, outside, last = 12.0, 5.0, 8.0
    print(f"\n{name}: minutes, temperature, power")
    for minute in range(121):
        error = 20.0 - room
        power = control(error, error - last)
        last = error
        room += (power - 60.0 * (room - outside)) / 5000.0  # a heater and a leak
        if minute % 20 == 0:
            print(f"{minute:5d} {room:8.2f} °C {power:8.0f} W")
    assert abs(room - 20.0) < 0.5
