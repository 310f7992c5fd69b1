#!/usr/bin/env python
# coding: utf-8

# # Comfort of a room

# In[1]:


get_ipython().run_line_magic('matplotlib', 'inline')
%config InlineBackend.figure_format = 'svg'
!pip install scikit-fuzzy
import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl


# In[2]:


heat = ctrl.Antecedent(np.arange(10, 35.5, 0.5), 'heat')
damp = ctrl.Antecedent(np.arange(0, 101, 1), 'damp')
comfort = ctrl.Consequent(np.arange(0, 10.1, 0.1), 'comfort')
heat['cool'] = fuzz.sigmf(heat.universe, 18, -1)
heat['nice'] = fuzz.gaussmf(heat.universe, 22, 2)
heat['warm'] = fuzz.sigmf(heat.universe, 26, 1)
damp['dry'] = fuzz.zmf(damp.universe, 20, 45)
damp['fine'] = fuzz.pimf(damp.universe, 20, 40, 55, 75)
damp['wet'] = fuzz.smf(damp.universe, 55, 80)
comfort.automf(3)
display(heat)


# In[3]:


room = ctrl.ControlSystem([
    ctrl.Rule(heat['nice'] & damp['fine'], comfort['good']),
    ctrl.Rule(heat['cool'] | damp['dry'], comfort['average']),
    ctrl.Rule(heat['warm'] & damp['wet'], comfort['poor']),
])
room_sim = ctrl.ControlSystemSimulation(room)
room_sim.inputs({'heat': 23, 'damp': 50})
room_sim.compute()
room_sim.output
