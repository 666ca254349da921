#!/usr/bin/python3
"""Copies a data set as a worse rig would have recorded it, to fit the score to rigs that are not perfect.

  worsen_dataset.py DATASET COPY --seed N

Drawn once for the copy: errors of the calibration (right camera's rotation, baseline, focal lengths) and of the
measured objects (size). Drawn for every frame: blur, noise, contrast and brightness. Truth and masks are shared with
the original by hard links; model edges and poses no longer fit to the pixel, which is the point.
"""
import argparse
import os
import pathlib
import re
import shutil

import numpy as np
from PIL import Image, ImageFilter

ROTATION_DEG = 0.03   # of the right camera, standard deviation about each axis: 0.3 px
BASELINE = 0.015      # share
FOCAL = 0.002         # share
SIZE = 0.004          # share, of all objects together
BLUR_PX = (0.0, 1.0)  # standard deviation
NOISE = (0.0, 3.0)    # grey levels
CONTRAST = (0.5, 1.1)


def matrix(text, name):
    match = re.search(rf'{name}: !!opencv-matrix.*?data: \[(.*?)\]', text, re.S)
    return np.array([float(v) for v in match.group(1).split(',')]), match.span(1)


def with_matrix(text, name, values):
    _, (start, end) = matrix(text, name)
    return text[:start] + ', '.join(f'{v:.17g}' for v in values) + text[end:]


def rotation(angles):
    x, y, z = angles
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + skew + skew @ skew / 2


def worsen_calibration(text, random):
    turn = rotation(np.radians(ROTATION_DEG) * random.standard_normal(3))
    r, t = matrix(text, 'R')[0].reshape(3, 3), matrix(text, 'T')[0]
    u, _, v = np.linalg.svd(turn @ r)
    text = with_matrix(text, 'R', (u @ v).ravel())
    text = with_matrix(text, 'T', turn @ t * (1 + BASELINE * random.standard_normal()))
    for name in ('K1', 'K2'):
        k = matrix(text, name)[0]
        k[[0, 4]] *= 1 + FOCAL * random.standard_normal()
        text = with_matrix(text, name, k)
    return text


def worsen_models(folder, scale):
    for path in folder.glob('*.ply'):
        head, body = path.read_text().split('end_header\n', 1)
        count = next(int(line.split()[2]) for line in head.splitlines() if line.startswith('element vertex'))
        lines = body.splitlines()
        for i in range(count):
            fields = lines[i].split()
            lines[i] = ' '.join([f'{float(v) * scale:.4f}' for v in fields[:3]] + fields[3:])
        path.write_text(head + 'end_header\n' + '\n'.join(lines) + '\n')


def worsen_image(source, target, look, random):
    image = Image.open(source).filter(ImageFilter.GaussianBlur(look['blur_px']))
    grey = np.asarray(image, float)
    grey = look['level'] + look['contrast'] * (grey - grey.mean()) + look['noise'] * random.standard_normal(grey.shape)
    Image.fromarray(np.clip(np.round(grey), 0, 255).astype(np.uint8)).save(target, compress_level=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('dataset', type=pathlib.Path)
    parser.add_argument('copy', type=pathlib.Path)
    parser.add_argument('--seed', type=int, default=1)
    args = parser.parse_args()
    if args.copy.exists():
        parser.error(f'{args.copy} exists; remove it first')
    random = np.random.default_rng(args.seed)
    shutil.copytree(args.dataset, args.copy, copy_function=os.link)
    calibration = args.copy / 'calib.yaml'
    text = worsen_calibration(calibration.read_text(), random)
    calibration.unlink()
    calibration.write_text(text)
    shutil.rmtree(args.copy / 'models')
    shutil.copytree(args.dataset / 'models', args.copy / 'models')
    worsen_models(args.copy / 'models', 1 + SIZE * random.standard_normal())
    for left in sorted(args.copy.glob('test/*/gray_cam1/*.png')):
        look = {'blur_px': random.uniform(*BLUR_PX), 'noise': random.uniform(*NOISE),
                'contrast': random.uniform(*CONTRAST), 'level': random.uniform(90, 140)}
        for path in (left, left.parent.parent / 'gray_cam2' / left.name):
            source = args.dataset / path.relative_to(args.copy)
            path.unlink()
            worsen_image(source, path, look, random)


if __name__ == '__main__':
    main()
