#!/usr/bin/python3
"""fit_pairs.py finds the weights that made the pairs, writes them as they are and keeps squared differences from speaking
for a pair. Ends with 77, for skipped, without scikit-learn."""
import contextlib
import importlib.util
import io
import pathlib
import re
import sys
import tempfile

try:
    import numpy as np
    import sklearn  # noqa: F401
except ImportError:
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / 'tools/evaluation/fit_pairs.py'
TERMS = re.findall(r'"(\w+)"', (ROOT / 'src/stages/pair_rank.cpp').read_text().split('kNames = {')[1].split('}')[0])


def load():
    spec = importlib.util.spec_from_file_location('fit_pairs', SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write_pairs(path, random, count):
    """Pairs whose odds rise with promotion and fall with angle_squared; distance_squared speaks for them, by chance."""
    terms = random.normal(size=(count, len(TERMS)))
    kind = np.arange(count) % 4
    for name in ('angle_sigma', 'angle_squared', 'distance_squared'):
        terms[kind == 0, TERMS.index(name)] = 0  # has no depth
    log_odds = 2 * terms[:, TERMS.index('promotion')] - terms[:, TERMS.index('angle_squared')] \
        + 0.5 * terms[:, TERMS.index('distance_squared')] - 1
    right = random.random(count) < 1 / (1 + np.exp(-log_odds))
    rows = ['scene_id,im_id,obj_id,instance,weight,class,' + ','.join(TERMS)]
    for i in range(count):
        rows.append(f'{i % 40},{i},1,{0 if right[i] else -1},1,{kind[i]},' + ','.join(f'{v:.6g}' for v in terms[i]))
    path.write_text('\n'.join(rows) + '\n')


def run(module, *arguments):
    """What the program prints; its error where it ends with one."""
    sys.argv = ['fit_pairs.py', *map(str, arguments)]
    out = io.StringIO()
    try:
        with contextlib.redirect_stdout(out):
            module.main()
    except SystemExit as error:
        return str(error)
    return out.getvalue()


def main():
    module = load()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        pairs, table, other = (folder / name for name in ('pairs.csv', 'table.cpp', 'other.csv'))
        write_pairs(pairs, np.random.default_rng(1), 20000)
        other.write_text('a,b\n1,2\n')
        text = run(module, pairs, '--table', table)
        assert 'share with one among the best' in text, text
        rows = re.findall(r'^    \{(.*?)F, \{(.*?)\}\},', table.read_text(), re.M)
        assert len(rows) == 4, rows
        for kind, (bias, weights) in enumerate(rows):
            weight = dict(zip(TERMS, (float(w.strip().rstrip('F')) for w in weights.split(','))))
            assert len(weight) == len(TERMS) and abs(weight['promotion'] - 2) < 0.3 and abs(float(bias) + 1) < 0.3, weight
            assert weight['distance_squared'] == -0.02, weight
            assert (weight['angle_squared'] == -0.02) if kind == 0 else abs(weight['angle_squared'] + 1) < 0.2, weight
        assert 'other.csv: no columns scene_id to promotion' in run(module, other)


main()
