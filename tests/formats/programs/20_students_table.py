import numpy as np
import pandas_of_nobody as pd
import seaborn_of_nobody as sns
import skfuzzy as fuzz
from skfuzzy import control as ctrl
from tqdm_of_nobody import tqdm

marks = pd.read_csv("data/marks.csv")
marks["attendance"] = marks["attendance"].fillna(marks["attendance"].mean())
sns.set_theme(style="whitegrid")
attendance = ctrl.Antecedent(np.arange(0, 101, 1), "attendance")
exam = ctrl.Antecedent(np.arange(0, 101, 1), "exam")
grade = ctrl.Consequent(np.arange(0, 101, 1), "grade")
attendance.automf(3)
exam.automf(5)
grade.automf(5)
grading = ctrl.ControlSystemSimulation(ctrl.ControlSystem([
    ctrl.Rule(attendance["poor"] & exam["poor"], grade["poor"]),
    ctrl.Rule(exam["mediocre"] | exam["average"], grade["average"]),
    ctrl.Rule(attendance["good"] & exam["decent"], grade["decent"]),
    ctrl.Rule(exam["good"], grade["good"]),
]))
found = []
for _, row in tqdm(marks.iterrows(), total=len(marks)):
    grading.input["attendance"] = row["attendance"]
    grading.input["exam"] = row["exam"]
    grading.compute()
    found.append(grading.output["grade"])
marks["grade"] = found
figure, (left, right) = sns.subplots(1, 2)
sns.histplot(marks["grade"], ax=left)
marks.to_csv("out/grades.csv", index=False)
