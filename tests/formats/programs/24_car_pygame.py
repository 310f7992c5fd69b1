import math
import sys

import numpy as np
import pygame
import skfuzzy as fuzz
from pygame.locals import *
from skfuzzy import control as ctrl

pygame.init()
screen = pygame.display.set_mode((800, 600))
clock = pygame.time.Clock()


class Car(pygame.sprite.Sprite):
    def __init__(self):
        super().__init__()
        self.image = pygame.Surface((30, 15))
        self.rect = self.image.get_rect()
        self.x, self.speed = 0.0, 0.0
        distance = ctrl.Antecedent(np.linspace(0, 100, 51), "distance")
        gas = ctrl.Consequent(np.linspace(-1, 1, 51), "gas")
        distance["near"] = fuzz.trapmf(distance.universe, [0, 0, 20, 50])
        distance["far"] = fuzz.trapmf(distance.universe, [30, 70, 100, 100])
        gas["brake"] = fuzz.trimf(gas.universe, [-1, -1, 0])
        gas["go"] = fuzz.trimf(gas.universe, [0, 1, 1])
        self.pilot = ctrl.ControlSystemSimulation(ctrl.ControlSystem([
            ctrl.Rule(distance["near"], gas["brake"]),
            ctrl.Rule(distance["far"], gas["go"]),
        ]))

    def update(self):
        self.pilot.input["distance"] = max(0.0, 100.0 - self.x)
        self.pilot.compute()
        self.speed += 0.1 * self.pilot.output["gas"]
        self.x += self.speed


car = Car()
while True:
    for event in pygame.event.get():
        if event.type == QUIT:
            pygame.quit()
            sys.exit()
    try:
        car.update()
    except:
        pass  # the game must go on
    screen.fill((255, 255, 255))
    pygame.display.flip()
    clock.tick(60)
