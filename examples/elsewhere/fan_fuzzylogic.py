"""How fast a fan runs, with fuzzylogic: sets are attributes of domains, a rule a dictionary."""

from fuzzylogic.classes import Domain, Rule
from fuzzylogic.functions import R, S, triangular
from fuzzylogic.hedges import very

temp = Domain("temperature", 0, 40)
hum = Domain("humidity", 0, 100)
fan = Domain("speed", 0, 2000, res=10)

temp.cold = S(5, 18)
temp.warm = triangular(12, 30)
temp.hot = R(22, 35)
hum.dry = S(20, 50)
hum.wet = R(40, 70)
fan.slow = S(200, 700)
fan.middle = triangular(400, 1600)
fan.fast = R(1200, 1800)

rules = Rule(
    {
        (temp.cold, hum.dry): fan.slow,
        (temp.cold, hum.wet): fan.slow,
        (temp.warm, hum.dry): fan.slow,
        (temp.warm, hum.wet): fan.middle,
        (temp.hot, hum.dry): fan.middle,
        (temp.hot, hum.wet): fan.fast,
        (very(temp.hot), hum.wet): fan.fast,
    }
)

print(rules({temp: 28, hum: 55}))
