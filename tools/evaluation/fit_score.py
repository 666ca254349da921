#!/usr/bin/python3
"""Fits the score (src/stages/score.h) to candidates of simulated scenes and writes src/stages/score_table.cpp, or the
rank of line sets (src/stages/set_rank.h) and src/stages/rank_table.cpp.

  fit_score.py score CANDIDATES.csv... [--also CANDIDATES.csv...] [--table FILE]
  fit_score.py rank SETS.csv... [--also SETS.csv...] [--table FILE]

The files come from `wirepose eval --candidates` and `--sets`. Right is a pose within 0.1 diameters of a true instance,
or 0.15 before it is adjusted. Scenes with more objects than are usual, `--also`, are fitted to but not judged by; their
right poses weigh as little as makes them as rare as in the others. Gradient boosted trees of fixed depth (Friedman
2001; second order leaves as in Chen & Guestrin 2016; scikit-learn's) under monotonicity constraints where a term's
direction is known. Prints a reliability table from 5-fold cross validation by scene. Copies of a scene must keep its
number, so that they fall into one fold.
"""
import argparse
import csv
import dataclasses
import pathlib

import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier

DEPTH = 5
RISING = {'visible_px', 'inside', 'support', 'sharp', 'sharp_of_support', 'full_edges', 'weakest_edge', 'distinct',
          'clear', 'dimmest_edge', 'outline', 'outline_distinct', 'inner_distinct', 'ends', 'corners',
          'weakest_face', 'on', 'drop', 'stands', 'end_peak', 'moved_peak', 'turned_peak'}
FALLING = {'chance', 'spread_px', 'parallax_px', 'weak_edges', 'overrun', 'crossed', 'crossing', 'crossings',
           'inner_crossings', 'beyond', 'across', 'hidden', 'through', 'level', 'misfit', 'rms_px', 'shift_px',
           'uncertainty', 'hangs', 'gap', 'rival_inward', 'rival_outward', 'rival_left', 'moved', 'turned'}
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


KINDS = {'score': Kind('visible_px', 'turned_peak', 0.1, 300, 0.06, 'score.h', 'score_table.cpp', 'DefaultScoreTable'),
         'rank': Kind('score', 'hypotheses', 0.15, 60, 0.12, 'set_rank.h', 'rank_table.cpp', 'DefaultRankTable')}


class Data:
    def __init__(self, kind, files, also):
        parts = [self.read(kind, file) for file in files + also]
        self.names = parts[0][0]
        self.terms = np.concatenate([terms for _, terms, _, _ in parts])
        self.right = np.concatenate([error < kind.right_d for _, _, error, _ in parts])
        self.scene = np.concatenate([scene for _, _, _, scene in parts])
        self.usual = np.repeat([True] * len(files) + [False] * len(also), [len(error) for _, _, error, _ in parts])
        if not self.right[self.usual].any():
            raise SystemExit('fit_score.py: no right pose in the files; name those of scenes with objects')
        self.weight = np.ones(len(self.right))
        if also:
            self.weight[~self.usual & self.right] = self.odds(self.usual) / self.odds(~self.usual)

    def odds(self, rows):
        return self.right[rows].sum() / max(1, (~self.right[rows]).sum())

    @staticmethod
    def read(kind, path):
        with open(path, newline='') as file:
            columns = next(csv.reader(file), [])
            if not {kind.first, kind.last, 'error_d', 'scene_id'} <= set(columns):
                raise SystemExit(f'fit_score.py: {path}: no columns {kind.first} to {kind.last}; candidates come from '
                                 '`wirepose eval --candidates`, line sets from `--sets`')
            names = columns[columns.index(kind.first):columns.index(kind.last) + 1]
            wanted = names + ['error_d', 'scene_id']
            rows = np.loadtxt(file, delimiter=',', usecols=[columns.index(name) for name in wanted], ndmin=2)
        rows = rows.reshape(-1, len(wanted))
        return names, rows[:, :-2].astype(np.float32), rows[:, -2], rows[:, -1].astype(int)


def fit(kind, data, rows):
    signs = [(n in RISING) - (n in FALLING) for n in data.names]
    booster = HistGradientBoostingClassifier(
        learning_rate=kind.rate, max_iter=kind.rounds, max_depth=DEPTH, max_leaf_nodes=None, l2_regularization=3,
        max_bins=64, monotonic_cst=signs, early_stopping=False, random_state=1)
    return booster.fit(data.terms[rows], data.right[rows], data.weight[rows])


def complete(nodes):
    """The tree as splits in heap order as (term, threshold), then leaves. Below a leaf that came early all goes left."""
    splits, leaves = [(0, np.inf)] * (2**DEPTH - 1), [0.0] * 2**DEPTH

    def place(node, heap):
        if heap >= len(splits):
            leaves[heap - len(splits)] = node['value']
            return
        if not node['is_leaf']:
            splits[heap] = (node['feature_idx'], node['num_threshold'])
        for side, child in ((1, 'left'), (2, 'right')):
            place(node if node['is_leaf'] else nodes[node[child]], 2 * heap + side)

    place(nodes[0], 0)
    return splits, leaves


def number(value):
    text = f'{np.float32(min(value, 1e30)):.8g}'
    return (text if '.' in text or 'e' in text else text + '.') + 'F'


def table(kind, booster):
    trees = [complete(stage[0].nodes) for stage in booster._predictors]
    lines = ['// Written by tools/evaluation/fit_score.py; do not edit.', f'#include "stages/{kind.header}"', '',
             'namespace wirepose {', '', '// clang-format off', f'const ScoreTable& {kind.function}() {{',
             f'  static constexpr std::array<ScoreTree, {len(trees)}> kTrees = {{{{']
    for splits, leaves in trees:
        texts = ', '.join(f'{{{term}, {number(threshold)}}}' for term, threshold in splits)
        values = ', '.join(number(leaf) for leaf in leaves)
        lines.append(f'    {{{{{{{texts}}}}}, {{{values}}}}},')
    bias = number(float(np.ravel(booster._baseline_prediction)[0]))
    lines += ['  }};', f'  static constexpr ScoreTable kTable{{{bias}, kTrees}};', '  return kTable;', '}',
              '// clang-format on', '', '}  // namespace wirepose', '']
    return '\n'.join(lines)


def reliability(kind, data):
    p = np.zeros(len(data.right))
    for k in range(5):
        held = (data.scene % 5 == k) & data.usual
        p[held] = fit(kind, data, data.scene % 5 != k).predict_proba(data.terms[held])[:, 1]
    right, p = data.right[data.usual], p[data.usual]
    print(f'cross validation: mean log loss {-np.log(np.where(right, p, 1 - p)).mean():.4f}')
    order = np.argsort(-p)
    precision = right[order].cumsum() / np.arange(1, len(p) + 1)
    for wanted in (0.9, 0.95):
        kept = np.flatnonzero(precision >= wanted)
        share = right[order][:kept[-1] + 1].sum() / right.sum() if len(kept) else 0
        print(f'right poses kept where {wanted:.0%} are right: {share:.3f}')
    print('score       n  right')
    for low in np.arange(0, 1, 0.1):
        inside = (p >= low) & (p < low + 0.1 + 1e-9)
        if inside.any():
            print(f'{low:.1f}-{low + 0.1:.1f} {inside.sum():6}  {right[inside].mean():.2f}  '
                  f'(mean score {p[inside].mean():.2f})')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('kind', choices=KINDS)
    parser.add_argument('files', nargs='+', metavar='FILE.csv')
    parser.add_argument('--also', nargs='+', default=[], metavar='FILE.csv')
    parser.add_argument('--table', type=pathlib.Path)
    args = parser.parse_args()
    kind = KINDS[args.kind]
    file = args.table or STAGES / kind.table
    data = Data(kind, args.files, args.also)
    print(f'{len(data.right)} poses, {int(data.right.sum())} right, {len(data.names)} terms')
    reliability(kind, data)
    booster = fit(kind, data, slice(None))
    file.write_text(table(kind, booster))
    print(f'{file}: {len(booster._predictors)} trees')


if __name__ == '__main__':
    main()
