"""Status 2 is a command that is written wrong, status 1 an input that is at fault."""

import shlex
import shutil

import pytest

from fuzzyarm import shipped
from fuzzyarm.apps.cli.main import main

WRONG_USAGE = """\
prove
prove pd7.frb --range --plot x.png
prove pd7.frb --along e=1
prove pd7.frb --certificate x.json
prove pd7.frb servo.frb --range
prove servo.frb --stable
prove servo.frb --plant motor --from "position in 1 .. 2"
prove pd7.frb --table lineer
simulate
simulate servo.frb --for 2x
simulate servo.frb --step 1 --reference position=1
simulate servo.frb --noise position
simulate servo.frb --plot x.xyz
simulate servo.frb --watch --json
sweep servo.frb --for 50ms
sweep servo.frb --sweep J
sweep servo.frb --sweep J=0.01..0.02:2 --resume
sweep servo.frb --sweep J=0.01..0.02:2 --metric rmss
sweep servo.frb --sweep J=0.01..0.02:2 --map J,R
compare servo.frb --plot x.xyz
compile pd7.frb -o x.xyz
compile pd7.frb -o x.h --table --direct
learn --joint 1
learn --freeze -o x.lut
tune servo.frb --resume
tune servo.frb --time 2x
fit data.csv -o model.xyz
fit data.csv -o model.frb --words 3..x
fit data.csv -o model.frb --words 3 --terms 2,2
check servo.frb --connect position=angle
eval pd7.frb 7
eval pd7.frb e=x ce=0
eval pd7.frb e=nan ce=0
eval pd7.frb e=1 ce=0 --defuzzifier centroid(0)
prove pd7.frb --range --tolerance -1
simulate servo.frb --for 0s
simulate servo.frb --seed -1
simulate servo.frb --noise position=-1
simulate servo.frb --actuator voltage=5..1
simulate servo.frb --reference position=stp:1
simulate servo.frb --step 1e99
simulate pd --segment -1
simulate pd --supply -3
simulate pd --pi 5
compare pd --segment -1
sweep servo.frb --sweep J=2..1:3
tune servo.frb --time 0s
learn --rate 11
fit data.csv -o model.frb --rules 0
fit data.csv -o model.frb --words 9..3
compile pd7.frb -o x.h --levels 1
compile pd7.frb -o x.lut --tolerance 0
plot pd7.frb -o x.png --plant motor
"""

AT_FAULT = """\
prove none.frb
prove servo.frb --plant motro --stable
prove pd7.frb --range --output x
prove --check pd7.frb
simulate none.frb
simulate pd7.frb
simulate servo.frb --noise positon=1
simulate servo.frb --plot no/x.png
simulate servo.frb --csv no/x.csv
simulate servo.frb --set K_X=3
sweep servo.frb --sweep JJ=1..2:2
compare servo.frb --plot no/x.png
compile none.frb -o x.h
compile pd7.frb -o no/x.h
tune none.frb
tune pd7.frb
fit none.csv -o model.frb
validate pd7.frb none.csv
eval pd7.frb e=1
show none.frb
plot pd7.frb -o no/x.png
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    for name in ("pd7.frb", "servo.frb"):
        shutil.copy(shipped(name), tmp_path)
    (tmp_path / "data.csv").write_text("a,b,y\n" + "1,2,3\n2,1,4\n" * 5)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("words", WRONG_USAGE.splitlines())
def test_wrong_usage(words, capsys):
    assert main(shlex.split(words)) == 2
    assert capsys.readouterr().err


@pytest.mark.parametrize("words", AT_FAULT.splitlines())
def test_an_input_at_fault(words, capsys):
    assert main(shlex.split(words)) == 1
    said = capsys.readouterr().err
    assert said
    assert "no/" not in words or "no such folder: 'no'" in said
