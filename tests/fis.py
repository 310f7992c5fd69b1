"""Heads of FIS files."""


def system(name: str, inputs: int = 1, rules: int = 2) -> str:
    """Return the head of a Mamdani system with min, max and centroid, and one output."""
    return (
        f"[System]\nName='{name}'\nType='mamdani'\nNumInputs={inputs}\nNumOutputs=1\n"
        f"NumRules={rules}\nAndMethod='min'\nOrMethod='max'\nImpMethod='min'\nAggMethod='max'\n"
        "DefuzzMethod='centroid'\n"
    )
