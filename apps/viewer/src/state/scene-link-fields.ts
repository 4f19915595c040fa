import type { Annotation } from './annotating.ts';
import type { Crop } from './inspecting.ts';
import { LINK_FIELDS } from './link-fields.ts';
import {
  type LinkPart,
  linkField,
  numberPart,
  readNumber,
  readParts,
  readVector,
  writeParts,
} from './link-parts.ts';
import {
  type KeptView,
  LEAST_STEP_MS,
  PASSINGS,
  type Passing,
  type PathSettings,
  type SavedView,
  USUAL_STEP_MS,
} from './saved-view.ts';
import { clamp, type Vec3 } from './vec3.ts';

/** Both corners of the box in the scene's own space, and which splats stay: `-1:0:-1:1:2:1:inside`. */
const crop = linkField(
  'crop',
  {
    subject: 'The crop of the address',
    form: 'crop=x:y:z:x:y:z:inside, with the min and then the max corner, or outside',
  },
  ({ min, max, keep }: Crop) => [...min, ...max, keep].join(':'),
  (text, refuse): Crop => {
    const parts = text.split(':').map((part) => part.trim());
    if (parts.length !== 7) throw refuse(`it has ${parts.length} parts`);
    const [x0, y0, z0, x1, y1, z1] = parts.slice(0, 6).map((part) => readNumber(part, refuse));
    const keep = parts[6];
    if (keep !== 'inside' && keep !== 'outside') throw refuse(`“${keep}” is neither inside nor outside`);
    const min: Vec3 = [x0, y0, z0];
    const max: Vec3 = [x1, y1, z1];
    const axis = [0, 1, 2].find((each) => min[each] > max[each]);
    if (axis !== undefined)
      throw refuse(`its min ${'xyz'[axis]}, ${min[axis]}, is above its max, ${max[axis]}`);
    return { min, max, keep };
  },
);

/** Decimals of an angle in radians: a hundredth of a pixel on a large screen. */
const ANGLE_DECIMALS = 5;
/** Significant digits of a length: finer steps are invisible at the view's distance. */
const LENGTH_DIGITS = 6;

/** The view as a camera, rounded to the visible; two views of the same text look the same. */
export function encodeKeptView(view: KeptView): string {
  const { target, distance, azimuth, polar, up } = view.pose;
  const far = Number(distance.toPrecision(LENGTH_DIGITS));
  return LINK_FIELDS.camera.encode({
    ...view,
    pose: {
      target: roundedPoint(target, far),
      distance: far,
      azimuth: rounded(azimuth, ANGLE_DECIMALS),
      polar: rounded(polar, ANGLE_DECIMALS),
      up,
    },
    fovDegrees: rounded(view.fovDegrees, ANGLE_DECIMALS),
    cameraIndex: 0,
  });
}

function decodeKeptView(text: string): KeptView {
  const { pose, fovDegrees, isOrthographic, isFlipped, isZUp } = LINK_FIELDS.camera.decode(text);
  return { pose, fovDegrees, isOrthographic, isFlipped, isZUp };
}

/** Rounded to the visible from `distance`, in world units. */
function roundedPoint([x, y, z]: Vec3, distance: number): Vec3 {
  const far = Number(distance.toPrecision(LENGTH_DIGITS));
  const decimals = clamp(LENGTH_DIGITS - 1 - Math.floor(Math.log10(far)), 0, 100);
  return [rounded(x, decimals), rounded(y, decimals), rounded(z, decimals)];
}

/** −0 becomes 0. */
function rounded(value: number, decimals: number): number {
  return Number(value.toFixed(decimals)) + 0;
}

/** The text before the first `mark`, and all that follows it; `mark` may stand in that again. */
function splitAt(text: string, mark: string): readonly [before: string, after: string] {
  const end = text.indexOf(mark);
  return end < 0 ? [text, ''] : [text.slice(0, end), text.slice(end + mark.length)];
}

const NAME = ',name:';

/** One of several words. */
function wordPart<Word extends string>(usual: Word, words: readonly Word[]): LinkPart<Word> {
  return {
    usual,
    write: (word) => word,
    read: (text, refuse, name) => {
      const found = words.find((word) => word === text);
      if (!found) throw refuse(`${name}:${text} is none of ${words.join(', ')}`);
      return found;
    },
  };
}

/** How the path goes on from a saved view: seconds to the next one, and how it is passed. */
const KEY_PARTS = {
  next: numberPart(USUAL_STEP_MS / 1000, (seconds) =>
    seconds >= LEAST_STEP_MS / 1000 ? null : `is below ${LEAST_STEP_MS / 1000} seconds`,
  ),
  pass: wordPart<Passing>('through', PASSINGS),
};
const IS_KEY_PART = new RegExp(`^(${Object.keys(KEY_PARTS).join('|')}):`);

/**
 * One saved view: as a camera, then how the path goes on from it if not as usual, then its name if
 * it has one, `0,0.1,0,2.5,0.35,1.25,next:4,pass:stop,name:From the door`. Numbers are rounded, as a
 * URL may have many views.
 */
const view = linkField(
  'view',
  { subject: 'It', form: 'view=x,y,z,distance,azimuth,polar, then any of next:2.5, pass:stop and name:Door' },
  ({ name, toNextMs, passing, ...camera }: KeptView & Omit<SavedView, 'thumbnail'>) => {
    const key = { next: toNextMs === undefined ? undefined : toNextMs / 1000, pass: passing };
    const title = name.trim();
    return `${[encodeKeptView(camera), ...writeParts(KEY_PARTS, key)].join(',')}${title && NAME + title}`;
  },
  (text, refuse): SavedView => {
    const [numbers, name] = splitAt(text, NAME);
    const parts = numbers.split(',').map((part) => part.trim());
    const isOfKey = (part: string) => IS_KEY_PART.test(part);
    const { next, pass } = readParts(KEY_PARTS, parts.filter(isOfKey), refuse);
    return {
      ...decodeKeptView(parts.filter((part) => !isOfKey(part)).join(',')),
      ...{ name: name.trim(), thumbnail: null },
      ...(next !== undefined && { toNextMs: Math.round(next * 1000) }),
      ...(pass !== undefined && { passing: pass }),
    };
  },
);

const LOOP = 'loop';
const TURNTABLE = 'turntable:';

/**
 * What the path has besides its views: `loop`, and a turntable's seconds and view,
 * `loop,turntable:10,0,0.1,0,2.5,0.35,1.25`; null for the usual.
 */
const path = linkField(
  'path',
  { subject: 'The path of the address', form: 'path=loop, or path=turntable:10 and a camera as in camera=' },
  ({ isLooped, turntable }: PathSettings): string | null => {
    const parts = isLooped ? [LOOP] : [];
    if (turntable) parts.push(`${TURNTABLE}${turntable.durationMs / 1000}`, encodeKeptView(turntable.view));
    return parts.length > 0 ? parts.join(',') : null;
  },
  (text, refuse): PathSettings => {
    const parts = text.split(',').map((part) => part.trim());
    const isLooped = parts[0] === LOOP;
    const [first, ...camera] = parts.slice(isLooped ? 1 : 0);
    if (first === undefined && isLooped) return { isLooped, turntable: null };
    if (!first?.startsWith(TURNTABLE)) throw refuse(`“${first}” is neither loop nor a turntable`);
    const seconds = readNumber(first.slice(TURNTABLE.length), refuse);
    if (seconds < (4 * LEAST_STEP_MS) / 1000) throw refuse(`${seconds} seconds are too short`);
    const view = decodeKeptView(camera.join(','));
    return { isLooped, turntable: { view, durationMs: Math.round(seconds * 1000) } };
  },
);

const WORDS = ',words:';

/**
 * One annotation: its point, the view that shows it, then its title and, from the next line on, its
 * text: `0:0.5:0,0,0.1,0,2.5,0.35,1.25,words:The jug`. Numbers are rounded like saved views.
 */
const annotation = linkField(
  'annotation',
  {
    subject: 'Its place',
    form: 'annotation=x:y:z, a comma, a camera as in camera=, and ,words:title',
  },
  ({ point, title, text, view: shown }: Annotation) => {
    const place = roundedPoint(point, shown.pose.distance).join(':');
    const words = text.trim() ? `${title.trim()}\n${text.trim()}` : title.trim();
    return `${place},${encodeKeptView(shown)}${words && WORDS + words}`;
  },
  (text, refuse): Annotation => {
    const [numbers, words] = splitAt(text, WORDS);
    const [place, ...camera] = numbers.split(',');
    const [title, ...lines] = words.split('\n');
    return {
      point: readVector(place, refuse, place, (part) => readNumber(part.trim(), refuse)),
      title: title.trim(),
      text: lines.join('\n').trim(),
      view: decodeKeptView(camera.join(',')),
    };
  },
);

/** Fields of the URL that belong to one scene and are read once it is drawn. */
export const SCENE_LINK_FIELDS = { crop, view, path, annotation };
