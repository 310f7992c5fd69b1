from fuzzylogic.classes import Domain, Rule, Set
from fuzzylogic.functions import R, S, triangular
from fuzzylogic.hedges import very

light = Domain("light", 0, 100, res=1)
heat = Domain("heat", 0, 40, res=0.5)
blind = Domain("blind", 0, 100, res=1)
light.dim, light.bright = S(20, 60), R(40, 80)
heat.cool, heat.hot = S(15, 22), R(20, 30)
blind.open, blind.half, blind.closed = S(10, 40), triangular(25, 75), R(60, 90)
rules = Rule({
    (light.dim, heat.cool): blind.open,
    (light.bright, heat.cool): blind.half,
    (light.dim, heat.hot): blind.half,
    (very(light.bright), heat.hot): blind.closed,
})
print(rules({light: 70, heat: 26}))
