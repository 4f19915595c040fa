import {
  FLAG,
  type LinkPart,
  linkField,
  numberPart,
  type Refuse,
  readFloat64,
  readParts,
  readVector,
  writeParts,
} from '../../state/link-parts.ts';
import { type PartLook, PLAIN_LOOK } from '../../state/scene-part.ts';
import { UP_AXES, type UpAxis } from '../../state/up-axis.ts';
import type { Vec3 } from '../../state/vec3.ts';
import { changedPlacement, type PlacedFile, placedLook, uprightPlacement } from '../open/placement.ts';

/** The product of a coordinate and a scale is a float32, like the numbers of a matrix. */
const FARTHEST = 1e24;
const LARGEST_SCALE = 1e12;

function readFinite(text: string, refuse: Refuse): number {
  const value = readFloat64(text, refuse);
  if (Math.abs(value) > FARTHEST) throw refuse(`${text} is not within ±${FARTHEST}`);
  return value;
}

function whyNotScale(scale: number): string | null {
  if (scale <= 0) return 'is not above 0';
  const isInRange = scale <= LARGEST_SCALE && scale >= 1 / LARGEST_SCALE;
  return isInRange ? null : `does not lie between ${1 / LARGEST_SCALE} and ${LARGEST_SCALE}`;
}

const POINT: LinkPart<Vec3> = {
  write: (vector) => vector.join(':'),
  read: (text, refuse, name) => readVector(text, refuse, `${name}:${text}`, readFinite),
};
const VECTOR: LinkPart<Vec3> = { usual: [0, 0, 0], ...POINT };

const AXES: LinkPart<{ readonly up: UpAxis; readonly sceneUp: UpAxis }> = {
  write: ({ up, sceneUp }) => `${up}:${sceneUp}`,
  read: (text, refuse) => {
    const [up, sceneUp] = text.split(':').map((name) => UP_AXES.find((axis) => axis === name));
    if (!up || !sceneUp) throw refuse(`up:${text} is not two of ${UP_AXES.join(', ')}`);
    return { up, sceneUp };
  },
};

const PARTS = {
  move: VECTOR,
  turn: VECTOR,
  scale: numberPart(1, whyNotScale, readFinite),
  about: POINT,
  up: AXES,
  opacity: numberPart(
    1,
    (part) => (part >= 0 && part <= 1 ? null : 'does not lie between 0 and 1'),
    readFinite,
  ),
  hidden: FLAG,
};

/**
 * The changed parts of a file's look, by name,
 * `move:0:1:0,turn:0:90:0,about:0.5:0:0,opacity:0.5`; an empty text for a file that is drawn as it
 * was saved. A look is read as a function, since the file completes it once it has arrived.
 */
export const PLACE_FIELD = linkField(
  'place',
  {
    subject: 'The place of a file',
    form: 'place=, once for each file: any of move:x:y:z, turn:x:y:z (degrees), scale:1, about:x:y:z, up:-y:y (its own axis, the scene’s), opacity:1 and hidden:1',
  },
  ({ isHidden, opacity, placement }: PartLook) => {
    const { move, turnDegrees: turn, scale, about, up, sceneUp } = placement ?? {};
    // Nothing but turns and scales depends on the centre.
    const isCentred = scale === 1 && turn?.every((degrees) => degrees === 0);
    return writeParts(PARTS, {
      move,
      turn,
      scale,
      about: isCentred ? undefined : about,
      up: up && sceneUp && up !== sceneUp ? { up, sceneUp } : undefined,
      opacity,
      hidden: isHidden,
    }).join(',');
  },
  (text, refuse) => {
    const parts = text.split(',').filter((part) => part !== '');
    const { turn, about, up, opacity = 1, hidden = false, ...named } = readParts(PARTS, parts, refuse);
    const change = { ...named, ...(turn && { turnDegrees: turn }), ...up };
    const look = { ...PLAIN_LOOK, opacity, isHidden: hidden };
    if (Object.keys(change).length === 0) return () => look;
    return (file: PlacedFile): PartLook => {
      const upright = uprightPlacement(file, file.ownUp);
      const placement = changedPlacement(upright, change, file);
      return placedLook(look, about ? { ...placement, about } : placement, file);
    };
  },
);
