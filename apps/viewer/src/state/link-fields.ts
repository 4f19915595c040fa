import {
  checkDetail,
  type Detail,
  InvalidArgumentError,
  isAccuracyTarget,
  printable,
} from '@websplatter/core';
import type { Comparison, ComparisonSide } from './accuracy.ts';
import { decodeAccuracy, encodeAccuracy } from './accuracy-address.ts';
import { type Background, FIRST_LOOK } from './camera.ts';
import { isFiniteF32 } from './float32.ts';
import {
  FLAG,
  type LinkField,
  type LinkPart,
  linkField,
  numberPart,
  type Refuse,
  readNumber,
  readParts,
  writeParts,
} from './link-parts.ts';
import type { LinkedCamera } from './saved-view.ts';
import type { Vec3 } from './vec3.ts';
import { VIEW_MODE_NAMES, type ViewModeName } from './view-mode.ts';

/** How far the length of `up` may be from 1, so that people can write addresses too. */
const UNIT_TOLERANCE = 1e-3;

const UP: LinkPart<Vec3> = {
  usual: [0, 1, 0],
  write: (up) => up.join(':'),
  read: (text, refuse) => {
    const [x, y, z, ...others] = text.split(':').map((part) => readNumber(part, refuse));
    const up: Vec3 = [x, y, z];
    // The length is NaN if a number is missing, and no comparison with NaN holds.
    const isUnit = Math.abs(Math.hypot(...up) - 1) < UNIT_TOLERANCE;
    if (!isUnit || others.length > 0) throw refuse(`up:${text} is no direction of length 1`);
    return up;
  },
};

const CAMERA_PARTS = {
  up: UP,
  fov: numberPart(FIRST_LOOK.fovDegrees, (degrees) =>
    degrees > 0 && degrees < 180 ? null : 'does not lie between 0 and 180 degrees',
  ),
  parallel: FLAG,
  flipped: FLAG,
  zup: FLAG,
  own: numberPart(0, (index) =>
    Number.isInteger(index) && index >= 0 ? null : 'is not a whole number from 0',
  ),
};

/**
 * The target, the distance from it, and both angles in radians, then by name all that is not as
 * usual: `0,0.1,0,2.5,0.35,1.25,fov:40,flipped:1`.
 */
const camera = linkField(
  'camera',
  {
    subject: 'The camera',
    form: 'camera=x,y,z,distance,azimuth,polar, then any of up:x:y:z, fov:50, parallel:1, flipped:1, zup:1 and own:0',
  },
  ({ pose, fovDegrees, isOrthographic, cameraIndex, isFlipped, isZUp }: LinkedCamera) => {
    const { target, distance, azimuth, polar, up } = pose;
    const parts = writeParts(CAMERA_PARTS, {
      up,
      fov: fovDegrees,
      parallel: isOrthographic,
      flipped: isFlipped,
      zup: isZUp,
      own: cameraIndex,
    });
    return [...target, distance, azimuth, polar, ...parts].join(',');
  },
  (text, refuse): LinkedCamera => {
    const parts = text.split(',').map((part) => part.trim());
    const numbers = [0, 1, 2, 3, 4, 5].map((i) => readNumber(parts[i] ?? '', refuse));
    const [x, y, z, distance, azimuth, polar] = numbers;
    if (distance <= 0) throw refuse(`its distance, ${distance}, is not above 0`);
    // The camera itself is somewhere around its target.
    if (![x, y, z].every((each) => isFiniteF32(Math.abs(each) + distance)))
      throw refuse(`${x}, ${y}, ${z} and a distance of ${distance} are beyond float32`);
    if (polar <= 0 || polar >= Math.PI)
      throw refuse(`its polar angle, ${polar}, does not lie between 0 and π`);
    const named = readParts(CAMERA_PARTS, parts.slice(6), refuse);
    return {
      pose: { target: [x, y, z], distance, azimuth, polar, up: named.up ?? [0, 1, 0] },
      fovDegrees: named.fov ?? FIRST_LOOK.fovDegrees,
      cameraIndex: named.own ?? 0,
      isOrthographic: named.parallel ?? false,
      isFlipped: named.flipped ?? false,
      isZUp: named.zup ?? false,
    };
  },
);

/** Two images at once, and the place of the line between them, 0…1 of the width. */
export interface LinkedComparison {
  readonly comparison: Comparison;
  readonly splitPart: number;
}

function sideText(side: ComparisonSide): string {
  return side === 'current' ? side : (encodeAccuracy(side, null) ?? '');
}

function sideIn(text: string, refuse: Refuse): ComparisonSide {
  if (text === 'current') return text;
  const accuracy = decodeAccuracy(text);
  if (isAccuracyTarget(accuracy))
    throw refuse(`“${text}” is a target, which only the chosen accuracy can be`);
  return accuracy;
}

/** `error`, or both sides of a split image and its line: `current/fast,resolutionScale:0.5/0.5`. */
const compare = linkField(
  'compare',
  {
    subject: 'The comparison',
    form: 'compare=error, or compare=current/fast/0.5 for two accuracies and the line between them',
  },
  ({ comparison, splitPart }: LinkedComparison) =>
    comparison.kind === 'error'
      ? 'error'
      : [sideText(comparison.left), sideText(comparison.right), splitPart].join('/'),
  (text, refuse): LinkedComparison => {
    if (text === 'error') return { comparison: { kind: 'error' }, splitPart: 0.5 };
    const [left, right, line = '0.5', ...others] = text.split('/');
    const splitPart = Number(line);
    if (right === undefined || others.length > 0) throw refuse(`“${text}” has not two sides`);
    if (line === '' || !(splitPart >= 0 && splitPart <= 1))
      throw refuse(`its line, “${line}”, does not lie between 0 and 1`);
    const comparison = { kind: 'split', left: sideIn(left, refuse), right: sideIn(right, refuse) } as const;
    return { comparison, splitPart };
  },
);

/** The name of a view mode; null for the usual one. */
const mode: LinkField<ViewModeName, ViewModeName, string | null> = {
  name: 'mode',
  encode: (name) => (name === 'colours' ? null : name),
  decode: (text) => {
    const found = VIEW_MODE_NAMES.find((name) => name === text);
    if (found) return found;
    throw new InvalidArgumentError(
      'mode',
      `The address asks for the view mode “${printable(text)}”; there are ${VIEW_MODE_NAMES.join(', ')}.`,
    );
  },
};

/** `auto`, or limits by name: `maxSplats:1200000`. */
const detail: LinkField<Detail> = {
  name: 'detail',
  encode: (value) =>
    typeof value === 'string' ? value : String(Object.entries(value).map((part) => part.join(':'))),
  decode: (text) => {
    const limits = () =>
      text.split(',').map((part): [string, number] => {
        const [name, value] = part.split(':');
        return [name, value ? Number(value) : Number.NaN];
      });
    const asked = (text.includes(':') ? Object.fromEntries(limits()) : text) as Detail;
    checkDetail(asked);
    return asked;
  },
};

/** A CSS colour without its #, which would end the query: `ff8000` or `f80`; null for the theme's. */
const background: LinkField<Background, Background, string | null> = {
  name: 'background',
  encode: (color) => (color === 'theme' ? null : color.slice(1)),
  decode: (text) => {
    const digits = /^#?([\da-f]{6}|[\da-f]{3})$/i.exec(text.trim())?.[1];
    if (digits)
      return `#${digits.length === 3 ? digits.replace(/./g, '$&$&') : digits}`.toLowerCase() as Background;
    throw new InvalidArgumentError(
      'background',
      `The background of the address, “${printable(text)}”, is no colour; write background=000 or background=ff8000.`,
    );
  },
};

/** Fields of the URL that the first picture needs, besides accuracy and the places of files. */
export const LINK_FIELDS = { camera, compare, mode, detail, background };
