#!/usr/bin/python3
"""The table that fit_score.py writes is the fit: read back and followed as src/stages/score.cpp does, it gives
scikit-learn's log odds. Ends with 77, for skipped, without scikit-learn."""
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

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / 'tools/evaluation/fit_score.py'
TERMS = ['score', 'score_share', 'residual_px', 'hypotheses']  # of a rank, the first and the last as they are there


def load():
    spec = importlib.util.spec_from_file_location('fit_score', SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write_sets(path, random, count):
    terms = random.normal(size=(count, len(TERMS))).astype(np.float32)
    is_right = terms[:, 0] - terms[:, 2] + 0.5 * random.normal(size=count) > 1
    rows = ['scene_id,im_id,error_d,' + ','.join(TERMS)]
    for i, row in enumerate(terms):
        rows.append(f'{i % 40},0,{0.05 if is_right[i] else 0.9},' + ','.join(f'{value:.9g}' for value in row))
    path.write_text('\n'.join(rows) + '\n')


def run(module, *arguments):
    """What the program prints; its error where it ends with one."""
    sys.argv = ['fit_score.py', *map(str, arguments)]
    out = io.StringIO()
    try:
        with contextlib.redirect_stdout(out):
            module.main()
    except SystemExit as error:
        return str(error)
    return out.getvalue()


def read_table(text, depth):
    bias = np.float32(re.search(r'kTable\{([^F]*)F', text).group(1))
    trees = []
    for line in re.findall(r'^    (\{\{.*\}),$', text, re.M):
        numbers = [np.float32(n.rstrip('F')) for n in re.findall(r'-?[0-9.][0-9.e+-]*F?', line)]
        splits = numbers[:2 * (2**depth - 1)]
        trees.append((list(zip(map(int, splits[::2]), splits[1::2])), numbers[len(splits):]))
    return bias, trees


def log_odds(bias, trees, terms):
    total = bias
    for splits, leaves in trees:
        node = 0
        while node < len(splits):
            term, threshold = splits[node]
            node = 2 * node + (2 if terms[term] > threshold else 1)
        total += leaves[node - len(splits)]
    return total


def main():
    module = load()
    random = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        usual, crowded, table, other = (folder / name for name in ('usual.csv', 'crowded.csv', 'table.cpp', 'other.csv'))
        write_sets(usual, random, 1500)
        write_sets(crowded, random, 500)
        other.write_text('a,b\n1,2\n')
        text = run(module, 'rank', usual, '--also', crowded, '--table', table)
        assert '2000 poses' in text and 'kept where 95% are right' in text, text
        kind = module.KINDS['rank']
        bias, trees = read_table(table.read_text(), module.DEPTH)
        assert len(trees) == kind.rounds and all(len(leaves) == 2**module.DEPTH for _, leaves in trees), len(trees)

        data = module.Data(kind, [usual], [crowded])
        lighter = data.weight[~data.usual & data.right]
        assert np.allclose(lighter, data.odds(data.usual) / data.odds(~data.usual)) and (data.weight[data.usual] == 1).all()
        wanted = module.fit(kind, data, slice(None)).decision_function(data.terms[:300])
        found = [log_odds(bias, trees, terms) for terms in data.terms[:300]]
        assert np.abs(wanted).max() > 1 and np.allclose(found, wanted, atol=1e-4), np.abs(found - wanted).max()

        assert 'other.csv: no columns score to hypotheses' in run(module, 'rank', other)


main()
