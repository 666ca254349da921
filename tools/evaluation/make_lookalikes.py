#!/usr/bin/python3
"""Adds scaled copies of a data set's models to it: look-alikes that are nowhere in its pictures.

  make_lookalikes.py DATASET [--scales 0.75,1.33]

Every model obj_00000N.ply (ASCII) gets copies obj_0000KN.ply, K = 1, 2, ... for the scales, with entries in
models_info.json. Whatever the recognizer finds of them is wrong: the hard negatives for fit_score.py.
"""
import argparse
import json
import pathlib


def scaled(text, scale):
    head, body = text.split('end_header\n', 1)
    count = next(int(line.split()[2]) for line in head.splitlines() if line.startswith('element vertex'))
    lines = body.splitlines()
    for i in range(count):
        fields = lines[i].split()
        lines[i] = ' '.join([f'{float(v) * scale:.4f}' for v in fields[:3]] + fields[3:])
    return head + 'end_header\n' + '\n'.join(lines) + '\n'


def scaled_info(info, scale):
    out = {k: v * scale if isinstance(v, (int, float)) else v for k, v in info.items()}
    for matrix in out.get('symmetries_discrete', []):
        assert all(matrix[i] == 0 for i in (3, 7, 11)), 'symmetries must leave the origin in place'
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('dataset', type=pathlib.Path)
    parser.add_argument('--scales', default='0.75,1.33')
    args = parser.parse_args()
    models = args.dataset / 'models'
    info = json.loads((models / 'models_info.json').read_text())
    for key in [k for k in info if int(k) < 10]:
        text = (models / f'obj_{int(key):06d}.ply').read_text()
        for k, scale in enumerate(args.scales.split(','), 1):
            copy = 10 * k + int(key)
            (models / f'obj_{copy:06d}.ply').write_text(scaled(text, float(scale)))
            info[str(copy)] = scaled_info(info[key], float(scale))
    (models / 'models_info.json').write_text(json.dumps(info, indent=1))


if __name__ == '__main__':
    main()
