#!/usr/bin/python3
"""Fits the score (src/stages/score.h) to candidates of simulated scenes and writes src/stages/score_table.cpp, or the
rank of line sets (src/stages/set_rank.h) and src/stages/rank_table.cpp.

  fit_score.py score CANDIDATES.csv[:WEIGHT]... [--table FILE]
  fit_score.py rank SETS.csv[:WEIGHT]... [--table FILE]

The files come from `wirepose eval --candidates` and `--sets`; WEIGHT says how much a row of a file counts (1). Right is
a pose within 0.1 diameters of a true instance, or 0.15 before it is adjusted. Gradient boosted trees of fixed depth
(Friedman 2001; second order leaves as in Chen & Guestrin 2016) under monotonicity constraints where a term's direction is known. Prints a reliability table from
5-fold cross validation by scene. Copies of a scene must keep its number, so that they fall into one fold.
"""
import argparse
import csv
import dataclasses
import pathlib

import numpy as np

DEPTH = 4
BINS = 24
RIDGE = 3.0
RISING = {'visible_px', 'inside', 'support', 'sharp', 'sharp_of_support', 'full_edges', 'weakest_edge', 'distinct',
          'clear', 'dimmest_edge', 'outline', 'outline_distinct', 'inner_distinct', 'ends', 'corners',
          'weakest_face', 'on', 'drop', 'stands'}
FALLING = {'chance', 'spread_px', 'parallax_px', 'weak_edges', 'overrun', 'crossed', 'crossing', 'crossings',
           'inner_crossings', 'beyond', 'across', 'hidden', 'through', 'level', 'misfit', 'rms_px', 'uncertainty', 'hangs',
           'gap'}
STAGES = pathlib.Path(__file__).resolve().parents[2] / 'src/stages'


@dataclasses.dataclass
class Kind:
    first: str  # columns of the terms, in the order of the core's array
    last: str
    right_d: float  # error up to which a pose is right, diameters
    rounds: int
    rate: float
    header: str
    table: str
    function: str


KINDS = {'score': Kind('visible_px', 'gap', 0.1, 300, 0.06, 'score.h', 'score_table.cpp', 'DefaultScoreTable'),
         'rank': Kind('score', 'hypotheses', 0.15, 60, 0.12, 'set_rank.h', 'rank_table.cpp', 'DefaultRankTable')}


class Data:
    def __init__(self, kind, arguments):
        rows = []
        for argument in arguments:
            path, _, weight = argument.partition(':')
            with open(path, newline='') as file:
                rows += [(float(weight or 1), row) for row in csv.DictReader(file)]
        if not rows:
            raise SystemExit('fit_score.py: no candidates; name CSV files of `wirepose eval --candidates` or `--sets`')
        columns = list(rows[0][1])
        if not {kind.first, kind.last} <= set(columns):
            raise SystemExit(f'fit_score.py: {arguments[0]}: no columns {kind.first} to {kind.last}; candidates come from '
                             '`wirepose eval --candidates`, line sets from `--sets`')
        self.names = columns[columns.index(kind.first):columns.index(kind.last) + 1]
        self.terms = np.array([[float(row[name]) for name in self.names] for _, row in rows], np.float32)
        self.right = np.array([float(row['error_d']) < kind.right_d for _, row in rows], float)
        self.weight = np.array([weight for weight, _ in rows])
        self.fold = np.array([int(row['scene_id']) % 5 for _, row in rows])


class Tree:
    """A complete tree: splits in heap order as (term, threshold), then leaves."""

    def __init__(self):
        self.splits = [(0, np.inf)] * (2**DEPTH - 1)
        self.leaves = [0.0] * 2**DEPTH

    def predict(self, terms):
        node = np.zeros(len(terms), int)
        split_term = np.array([s[0] for s in self.splits])
        threshold = np.array([s[1] for s in self.splits])
        for _ in range(DEPTH):
            above = terms[np.arange(len(terms)), split_term[node]] > threshold[node]
            node = 2 * node + np.where(above, 2, 1)
        return np.array(self.leaves)[node - len(self.splits)]


class Booster:
    def __init__(self, kind, names):
        self.kind = kind
        self.sign = np.array([(n in RISING) - (n in FALLING) for n in names])
        self.trees = []
        self.bias = 0.0

    def fit(self, terms, right, weight):
        quantiles = np.linspace(0, 1, BINS + 1)[1:-1]
        self.cuts = [np.unique(np.quantile(column, quantiles).astype(np.float32)) for column in terms.T]
        self.bins = np.stack([np.searchsorted(c, column) for c, column in zip(self.cuts, terms.T)], 1)
        self.bias = np.log((weight * right).sum() / (weight * (1 - right)).sum())
        log_odds = np.full(len(right), self.bias)
        for _ in range(self.kind.rounds):
            p = 1 / (1 + np.exp(-log_odds))
            self.gradient, self.curvature = weight * (right - p), weight * p * (1 - p)
            tree = Tree()
            self.grow(tree, 0, np.arange(len(right)), -np.inf, np.inf)
            self.trees.append(tree)
            log_odds += tree.predict(terms)

    def predict(self, terms):
        return self.bias + sum(tree.predict(terms) for tree in self.trees)

    def grow(self, tree, node, rows, low, high):
        """Splits where it gains most; values of the children keep the order that the term's direction asks for."""
        g, h = self.gradient[rows].sum(), self.curvature[rows].sum()
        value = np.clip(g / (h + RIDGE), low, high)
        best = (1e-4, None)
        if node < len(tree.splits):
            for term in range(len(self.cuts)):
                best = max(best, self.best_cut(term, rows, g, h, value, low, high), key=lambda b: b[0])
        else:
            tree.leaves[node - len(tree.splits)] = self.kind.rate * value
            return
        if best[1] is None:  # everything goes left
            self.grow(tree, 2 * node + 1, rows, low, high)
            return
        _, (term, cut, left, right) = best
        tree.splits[node] = (term, float(self.cuts[term][cut]))
        below = self.bins[rows, term] <= cut
        middle = (left + right) / 2
        bounds = {0: (low, high, low, high), 1: (low, middle, middle, high), -1: (middle, high, low, middle)}
        a, b, c, d = bounds[int(self.sign[term])]
        self.grow(tree, 2 * node + 1, rows[below], a, b)
        self.grow(tree, 2 * node + 2, rows[~below], c, d)

    def best_cut(self, term, rows, g, h, value, low, high):
        count = len(self.cuts[term]) + 1
        bins = self.bins[rows, term]
        gl = np.bincount(bins, self.gradient[rows], count).cumsum()[:-1]
        hl = np.bincount(bins, self.curvature[rows], count).cumsum()[:-1]
        if len(gl) == 0:
            return (0, None)
        left = np.clip(gl / (hl + RIDGE), low, high)
        right = np.clip((g - gl) / (h - hl + RIDGE), low, high)

        def gain_of(gradient, curvature, v):
            return gradient * v - 0.5 * (curvature + RIDGE) * v * v
        gain = gain_of(gl, hl, left) + gain_of(g - gl, h - hl, right) - gain_of(g, h, value)
        gain = np.where((right - left) * self.sign[term] < 0, 0, gain)
        k = int(gain.argmax())
        return (gain[k], (term, k, left[k], right[k]))


def number(value):
    text = f'{np.float32(min(value, 1e30)):.8g}'
    return (text if '.' in text or 'e' in text else text + '.') + 'F'


def table(booster):
    kind = booster.kind
    lines = ['// Written by tools/evaluation/fit_score.py; do not edit.', f'#include "stages/{kind.header}"', '',
             'namespace wirepose {', '', '// clang-format off', f'const ScoreTable& {kind.function}() {{',
             f'  static constexpr std::array<ScoreTree, {len(booster.trees)}> kTrees = {{{{']
    for tree in booster.trees:
        splits = ', '.join(f'{{{term}, {number(threshold)}}}' for term, threshold in tree.splits)
        leaves = ', '.join(number(leaf) for leaf in tree.leaves)
        lines.append(f'    {{{{{{{splits}}}}}, {{{leaves}}}}},')
    lines += ['  }};', f'  static constexpr ScoreTable kTable{{{number(booster.bias)}, kTrees}};', '  return kTable;', '}',
              '// clang-format on', '', '}  // namespace wirepose', '']
    return '\n'.join(lines)


def reliability(kind, data):
    p = np.zeros(len(data.right))
    for k in range(5):
        held = data.fold == k
        booster = Booster(kind, data.names)
        booster.fit(data.terms[~held], data.right[~held], data.weight[~held])
        p[held] = 1 / (1 + np.exp(-booster.predict(data.terms[held])))
    loss = -(data.weight * np.log(np.where(data.right > 0, p, 1 - p))).sum() / data.weight.sum()
    print(f'cross validation: mean log loss {loss:.4f}\nscore       n  right')
    for low in np.arange(0, 1, 0.1):
        inside = (p >= low) & (p < low + 0.1 + 1e-9)
        n = data.weight[inside].sum()
        if n > 0:
            mean = [(data.weight * v)[inside].sum() / n for v in (data.right, p)]
            print(f'{low:.1f}-{low + 0.1:.1f} {n:6.0f}  {mean[0]:.2f}  (mean score {mean[1]:.2f})')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('kind', choices=KINDS)
    parser.add_argument('files', nargs='+', metavar='FILE.csv[:WEIGHT]')
    parser.add_argument('--table', type=pathlib.Path)
    args = parser.parse_args()
    kind = KINDS[args.kind]
    file = args.table or STAGES / kind.table
    data = Data(kind, args.files)
    print(f'{len(data.right)} poses, {int(data.right.sum())} right, {len(data.names)} terms')
    reliability(kind, data)
    booster = Booster(kind, data.names)
    booster.fit(data.terms, data.right, data.weight)
    file.write_text(table(booster))
    print(f'{file}: {len(booster.trees)} trees')


if __name__ == '__main__':
    main()
