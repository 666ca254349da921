#!/usr/bin/python3
"""Fits the weights of ScoreParams (src/stages/selection.h) to candidates of simulated scenes.

  fit_score.py CANDIDATES.csv[:WEIGHT]...      files of `wirepose eval --candidates`, and how much a row counts (1)

Right: within 0.1 diameters of a true instance. Regularised logistic regression (Newton's method); prints the
aggregates to paste into ScoreParams and a reliability table from 5-fold cross validation by scene.
"""
import csv
import sys

import numpy as np

COLUMNS = ['contrast', 'distinct', 'overrun', 'inside', 'faces', 'on', 'through', 'drop']
NAMES = ['bias', 'edge_density'] + COLUMNS
LOG_LENGTH = 1.0  # given, see ScoreParams


def features(row):
    length = max(1.0, float(row['visible_px']))
    return [1.0, 100 * float(row['edges']) / length] + [float(row[name]) for name in COLUMNS]


def given(row):
    return LOG_LENGTH * np.log(max(1.0, float(row['visible_px'])) / 300)


def fit(x, y, offset, weight, ridge=1.0):
    penalty = ridge * np.diag([0.0] + [1.0] * (x.shape[1] - 1))
    w = np.zeros(x.shape[1])
    for _ in range(100):
        p = 1 / (1 + np.exp(-x @ w - offset))
        step = np.linalg.solve((x * (weight * p * (1 - p))[:, None]).T @ x + penalty + 1e-9 * np.eye(len(w)),
                               x.T @ (weight * (y - p)) - penalty @ w)
        w += step
        if np.abs(step).max() < 1e-9:
            break
    return w


def main():
    rows = []
    for argument in sys.argv[1:]:
        path, _, weight = argument.partition(':')
        rows += [(float(weight or 1), row) for row in csv.DictReader(open(path, newline=''))]
    if not rows:
        sys.exit('fit_score.py: no candidates; name CSV files of `wirepose eval --candidates`')
    x = np.array([features(row) for _, row in rows])
    y = np.array([float(row['error_d']) < 0.1 for _, row in rows], float)
    offset = np.array([given(row) for _, row in rows])
    weight = np.array([weight for weight, _ in rows])
    fold = np.array([int(row['scene_id']) % 5 for _, row in rows])
    w = fit(x, y, offset, weight)
    print(f'{len(y)} candidates, {int(y.sum())} right')
    for name, value in zip(NAMES, w):
        print(f'  float {name} = {value:.3f}F;')
    p = np.zeros(len(y))
    for k in range(5):
        held, used = fold == k, fold != k
        p[held] = 1 / (1 + np.exp(-x[held] @ fit(x[used], y[used], offset[used], weight[used]) - offset[held]))
    print('score       n  right')
    for low in np.arange(0, 1, 0.1):
        inside = (p >= low) & (p < low + 0.1 + 1e-9)
        if inside.any():
            n = weight[inside].sum()
            print(f'{low:.1f}-{low + 0.1:.1f} {n:6.0f}  {(weight * y)[inside].sum() / n:.2f}  '
                  f'(mean score {(weight * p)[inside].sum() / n:.2f})')


if __name__ == '__main__':
    main()
