import type { AccuracySettings } from '@websplatter/core';
import { antialias, type EffectUse } from '@websplatter/core/effects';
import { formatRough } from '@websplatter/kit/format';
import type { Vec3 } from '../state/vec3.ts';
import type { MapFigures, ViewModeName } from '../state/view-mode.ts';
import { type DepthSubject, depthAt, viewDepthsOf } from './depth-range.ts';
import { contributionNotes, contributionScale, costScale, pixelNotes, tileNotes } from './map-scales.ts';
import {
  CENTRE_RADIUS_PX,
  COARSEST_LEVEL,
  centres,
  type DepthOptions,
  depthColors,
  ELLIPSOID_EDGE,
  ellipsoids,
  harmonicsColors,
  levelColors,
  MOST_STEPS,
  OVERDRAW_OPACITY,
  opacityColors,
  overdraw,
} from './mode-effects.ts';
import { DEPTH_RAMP, OVERDRAW_COLOR, UNSEEN_COLOR, VALUE_RAMP } from './ramp.ts';
import { type ColorScale, evenTicks } from './scale.ts';

/** Facts of a picture at rest, or of one side of it, that legends need. */
export interface PictureFacts {
  /** World to view, column-major. */
  readonly viewMatrix: ArrayLike<number>;
  /** sRGB, 0…1. */
  readonly background: Vec3;
  readonly subject: DepthSubject;
  readonly accuracy: Pick<AccuracySettings, 'alphaCutoff' | 'recordPrecision'>;
  /** Degree of the scene's harmonics. */
  readonly shDegree: number;
}

/** One way of showing the splats. */
export interface ViewMode {
  readonly name: ViewModeName;
  readonly label: string;
  /** Describes the picture. */
  readonly about: string;
  /** The effects that draw the mode. */
  readonly uses: (subject: DepthOptions) => readonly EffectUse[];
  readonly scale?: (facts: PictureFacts) => ColorScale;
  /** Only for modes with a map over the picture: the meaning of its colours, and its counts. */
  readonly map?: {
    readonly scale: (figures: MapFigures) => ColorScale | null;
    readonly notes: (figures: MapFigures) => readonly string[];
  };
  /** A caution about this picture; null if there is none. */
  readonly caution?: (facts: PictureFacts) => string | null;
}

/** A file's antialiasing makes thin splats fainter. Modes that replace opacities switch it off. */
const WITHOUT_ANTIALIAS = antialias(false);

/** Records that cannot hold opacities above 1 soften hard edges. */
const cautionOfEdges = ({ accuracy }: PictureFacts) =>
  accuracy.recordPrecision === 'paper'
    ? 'The splat records “paper” hold opacities of at most 1, so edges are soft here.'
    : null;

/** All modes, in the order of the menu. */
export const VIEW_MODES: readonly ViewMode[] = [
  {
    name: 'colours',
    label: 'Colours',
    about: 'The picture as the scene was trained.',
    uses: () => [],
  },
  {
    name: 'ellipsoids',
    label: 'Ellipsoids',
    about: `Every splat is solid up to ${ELLIPSOID_EDGE} standard deviations, whatever its opacity; neighbours differ in lightness, and none is thinner than 4 px.`,
    uses: () => [ellipsoids(), WITHOUT_ANTIALIAS],
    caution: cautionOfEdges,
  },
  {
    name: 'centres',
    label: 'Centres',
    about: `Every splat is a dot, ${2 * CENTRE_RADIUS_PX} px wide, in its colour, whatever its size and opacity.`,
    uses: () => [centres(), WITHOUT_ANTIALIAS],
    caution: cautionOfEdges,
  },
  {
    name: 'depth',
    label: 'Depth',
    about:
      'How far away the centres of splats are: the mean of 1/depth over a pixel’s splats, weighted by what each contributes.',
    uses: (subject) => [depthColors(subject)],
    scale({ subject, viewMatrix }) {
      const range = viewDepthsOf(subject, viewMatrix);
      const title = 'Depth along the view, in the scene’s units';
      return { title, ...DEPTH_RAMP, ticks: evenTicks((part) => formatRough(depthAt(range, part), 3)) };
    },
  },
  {
    name: 'opacity',
    label: 'Opacity',
    about:
      'How opaque splats are at their centres: the mean over a pixel’s splats, weighted by what each contributes.',
    uses: () => [opacityColors()],
    scale: () => ({
      title: 'Opacity',
      ...VALUE_RAMP,
      ticks: evenTicks(String),
    }),
  },
  {
    name: 'harmonics',
    label: 'Harmonics',
    about:
      'How far spherical harmonics change the base colours of splats, seen from here: the mean over a pixel’s splats, weighted by what each contributes.',
    uses: () => [harmonicsColors()],
    scale: () => ({
      title: 'Largest change of a channel, in steps of 1/255',
      ...VALUE_RAMP,
      ticks: evenTicks((part) => (part < 1 ? String(part * MOST_STEPS) : `≥ ${MOST_STEPS}`)),
    }),
    caution({ shDegree }) {
      if (shDegree === 0) return 'No harmonics above degree 0 are drawn: no colour depends on the view.';
      return `Harmonics of degree ${shDegree > 1 ? `1 to ${shDegree}` : '1'} are drawn.`;
    },
  },
  {
    name: 'overdraw',
    label: 'Overdraw',
    about:
      'The more splats lie over each other, the fuller the colour. A splat counts as 1 at its centre and as e^(−d²/2) at d standard deviations from there.',
    uses: () => [overdraw(), WITHOUT_ANTIALIAS],
    scale: ({ background }) => ({
      title: 'Splats over each other',
      low: { color: steps(background), name: 'the background' },
      high: OVERDRAW_COLOR,
      ticks: OVERDRAW_TICKS.map((count) => ({ part: overdrawPart(count), text: String(count) })),
    }),
    caution({ accuracy: { alphaCutoff } }) {
      const least = alphaCutoff / OVERDRAW_OPACITY;
      return least > 1
        ? 'The opacity cutoff is so high that nothing is counted; choose a lower one (Accuracy, C).'
        : `The opacity cutoff leaves out splats where they count as less than ${least.toFixed(2)}.`;
    },
  },
  {
    name: 'detail',
    label: 'Detail',
    about: `How coarse the detail is: each level stands for up to 16 times as many splats as the one before, the first for up to 256. Parts in ${UNSEEN_COLOR.name} still wait for finer detail.`,
    uses: () => [levelColors()],
    scale: () => ({
      title: 'Level of detail; 0 for splats themselves',
      ...VALUE_RAMP,
      ticks: Array.from({ length: COARSEST_LEVEL + 1 }, (_, level) => ({
        part: level / COARSEST_LEVEL,
        text: level < COARSEST_LEVEL ? String(level) : `≥ ${level}`,
      })),
    }),
  },
  {
    name: 'tile-cost',
    label: 'Tile cost',
    about: 'How many splats each tile of 8×8 pixels has to go through: the length of its list.',
    uses: () => [],
    map: { scale: (figures) => costScale('Splats in a tile’s list', figures), notes: tileNotes },
  },
  {
    name: 'pixel-cost',
    label: 'Pixel cost',
    about:
      'What each pixel takes: by tiles, the splats of its list until next to no light passes through; by quads, all splats that reach it.',
    uses: () => [],
    map: { scale: (figures) => costScale('Splats gone through at a pixel', figures), notes: pixelNotes },
  },
  {
    name: 'contribution',
    label: 'Contribution',
    about:
      'How much splats contribute to this picture: the sum of their shares of all pixels. A pixel shows the mean over its splats, weighted by their shares.',
    uses: () => [],
    map: { scale: contributionScale, notes: contributionNotes },
  },
];

const OVERDRAW_TICKS = [0, 10, 20, 40, 80];

/** Coverage 0…1 of the colour where `count` splats overlap. */
export function overdrawPart(count: number): number {
  return 1 - (1 - OVERDRAW_OPACITY) ** count;
}

export function viewModeOf(name: ViewModeName): ViewMode {
  return VIEW_MODES.find((mode) => mode.name === name)!;
}

/** Distinct cautions about a picture with one or two sides. */
export function cautionsOf(mode: ViewMode, sides: readonly PictureFacts[]): readonly string[] {
  const texts = sides.map((facts) => mode.caution?.(facts) ?? null);
  const isSame = texts.every((text) => text === texts[0]);
  return texts.flatMap((text, i) => {
    if (text === null || (isSame && i > 0)) return [];
    return isSame ? [text] : [`Side ${'AB'[i]}: ${text}`];
  });
}

/** sRGB, 0…255. */
function steps([red, green, blue]: Vec3): Vec3 {
  return [255 * red, 255 * green, 255 * blue];
}
