import numpy as np
import skfuzzy as fuzz
import streamlit as st
from skfuzzy import control as ctrl

st.set_page_config(page_title="loan", layout="wide")
st.title("Loan")


@st.cache_resource
def load_system():
    income = ctrl.Antecedent(np.linspace(0, 100, 101), "income")
    debt = ctrl.Antecedent(np.linspace(0, 100, 101), "debt")
    chance = ctrl.Consequent(np.linspace(0, 100, 101), "chance")
    for each in (income, debt, chance):
        each.automf(3)
    return ctrl.ControlSystem([
        ctrl.Rule(income["good"] & debt["poor"], chance["good"]),
        ctrl.Rule(income["average"] | debt["average"], chance["average"]),
        ctrl.Rule(income["poor"] & debt["good"], chance["poor"]),
    ])


system = load_system()
left, right = st.columns(2)
with left:
    income_value = st.slider("income", 0, 100, 50)
with right:
    debt_value = st.slider("debt", 0, 100, 20)
if st.button("evaluate"):
    simulation = ctrl.ControlSystemSimulation(system)
    simulation.input["income"] = income_value
    simulation.input["debt"] = debt_value
    simulation.compute()
    st.metric("chance", round(simulation.output["chance"], 1))
