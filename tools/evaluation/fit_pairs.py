#!/usr/bin/python3
"""Fits the rank of corresponding pairs (src/stages/pair_rank.h) and writes src/stages/pair_rank_table.cpp.

  fit_pairs.py PAIRS.csv... [--table FILE]

The files come from `wirepose eval --pairs`. One logistic regression a class (scikit-learn's) for whether both lines show
the edges that the pair says. An object with many right pairs needs only one of them: the more it has the less each
weighs. Prints, by scenes that were not fitted to, how many of the objects that have a right pair have one among the best
of their model and frame.
"""
import argparse
import csv
import pathlib

import numpy as np
from sklearn.linear_model import LogisticRegression

FIRST, LAST = 'base_px', 'promotion'
CLASSES = ['flat', 'parallel', 'corner', 'apart']
WITH_DEPTH = {'angle_sigma', 'distance_sigma', 'other_cover', 'other_cover_squared', 'reach', 'reach_squared',
              'angle_squared', 'distance_squared'}
MIN_LOSS = 0.02  # of a squared difference: the search for members is bounded by it
SHARED = 0.7     # exponent of how many right pairs an object has, by which each weighs less
TABLE = pathlib.Path(__file__).resolve().parents[2] / 'src/stages/pair_rank_table.cpp'


class Pairs:
    def __init__(self, files):
        parts = [self.read(file) for file in files]
        self.names = parts[0][0]
        rows = np.concatenate([rows for _, rows in parts])
        file = np.repeat(np.arange(len(files)), [len(rows) for _, rows in parts])
        scene, image, model, instance, self.weight, self.kind = rows[:, :6].T
        self.terms = rows[:, 6:].astype(np.float32)
        self.right = instance >= 0
        self.scene = scene.astype(int)
        if not self.right.any():
            raise SystemExit('fit_pairs.py: no right pair in the files; name those of scenes with objects')
        _, self.search = np.unique(np.stack([file, scene, image, model]), axis=1, return_inverse=True)
        _, self.object, count = np.unique(np.stack([self.search, instance]), axis=1, return_inverse=True,
                                          return_counts=True)
        self.fit_weight = np.where(self.right, count[self.object] ** -SHARED, self.weight)

    @staticmethod
    def read(path):
        with open(path, newline='') as file:
            columns = next(csv.reader(file), [])
            if columns[:4] != ['scene_id', 'im_id', 'obj_id', 'instance'] or columns[6:7] != [FIRST]:
                raise SystemExit(f'fit_pairs.py: {path}: no columns scene_id to {LAST}; pairs come from '
                                 '`wirepose eval --pairs`')
            return columns[6:], np.loadtxt(file, delimiter=',', ndmin=2).reshape(-1, len(columns))


def fit_class(pairs, kind, rows):
    """Bias and weights of one class, in the terms' own units."""
    used = np.array([kind > 0 or name not in WITH_DEPTH for name in pairs.names])
    rows = rows & (pairs.kind == kind)
    weights = np.zeros(len(pairs.names))
    while True:
        x = pairs.terms[rows][:, used].astype(float)
        mean, spread = x.mean(0), x.std(0) + 1e-6
        model = LogisticRegression(max_iter=500).fit((x - mean) / spread, pairs.right[rows], pairs.fit_weight[rows])
        weights[:] = 0
        weights[used] = model.coef_[0] / spread
        # More difference never speaks for a pair: what chance says so is left out.
        wrong = [i for i, name in enumerate(pairs.names)
                 if used[i] and name in ('angle_squared', 'distance_squared') and weights[i] > -MIN_LOSS]
        if not wrong:
            break
        used[wrong] = False
    bias = model.intercept_[0] - (model.coef_[0] * mean / spread).sum()
    for i, name in enumerate(pairs.names):
        if name in ('angle_squared', 'distance_squared'):
            weights[i] = min(weights[i], -MIN_LOSS)
    return bias, weights


def fit(pairs, rows):
    return [fit_class(pairs, kind, rows) for kind in range(len(CLASSES))]


def rank(pairs, table):
    bias = np.array([bias for bias, _ in table])
    weights = np.stack([weights for _, weights in table])
    kind = pairs.kind.astype(int)
    return bias[kind] + (pairs.terms * weights[kind]).sum(1)


def places(pairs, ranks, rows):
    """Of every object in the rows: the place of its best right pair among the pairs of its model and frame."""
    best = {}
    order = np.flatnonzero(rows)[np.lexsort((-ranks[rows], pairs.search[rows]))]
    before, search = 0.0, -1
    for i in order:
        if pairs.search[i] != search:
            before, search = 0.0, pairs.search[i]
        if pairs.right[i]:
            best.setdefault(pairs.object[i], before + 1)
        before += pairs.weight[i]
    return np.array(list(best.values()))


def number(value):
    text = f'{np.float32(value):.7g}'
    return (text if '.' in text or 'e' in text else text + '.0') + 'F'


def table_text(table):
    lines = ['// Written by tools/evaluation/fit_pairs.py; do not edit.', '#include "stages/pair_rank.h"', '',
             'namespace wirepose {', '', '// clang-format off', 'const PairWeightTable& DefaultPairWeights() {',
             '  static constexpr PairWeightTable kTable = {{']
    for name, (bias, weights) in zip(CLASSES, table):
        lines.append(f'    {{{number(bias)}, {{{", ".join(number(w) for w in weights)}}}}},  // {name}')
    lines += ['  }};', '  return kTable;', '}', '// clang-format on', '', '}  // namespace wirepose', '']
    return '\n'.join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('files', nargs='+', metavar='FILE.csv')
    parser.add_argument('--table', type=pathlib.Path, default=TABLE)
    arguments = parser.parse_args()
    pairs = Pairs(arguments.files)
    held = pairs.scene % 5 == 0
    if held.any() and (pairs.right & ~held).any() and (pairs.right & held).any():
        place = places(pairs, rank(pairs, fit(pairs, ~held)), held)
        print(f'{len(place)} objects with a right pair; share with one among the best N')
        print('  '.join(f'{n}: {(place <= n).mean():.3f}' for n in (128, 256, 512, 1024, 2048, 4096)))
    table = fit(pairs, np.ones(len(pairs.right), bool))
    for name, (bias, weights) in zip(CLASSES, table):
        print(name, f'{bias:.2f}', ' '.join(f'{n} {w:.2f}' for n, w in zip(pairs.names, weights)))
    arguments.table.write_text(table_text(table))
    print(f'written: {arguments.table}')


if __name__ == '__main__':
    main()
