import { InvalidArgumentError } from '@websplatter/core';
import { namedParts, numberPart } from '../state/address-parts.ts';
import { type PartLook, PLAIN_LOOK, type Placement } from '../state/scene-part.ts';
import { UP_AXES, type UpAxis } from '../state/up-axis.ts';
import type { Vec3 } from '../state/vec3.ts';
import { changedPlacement, type PlacedFile, placedLook, uprightPlacement } from './placement.ts';

const FORM =
  'write place=, once for each file: any of move:x:y:z, turn:x:y:z (degrees), scale:1, about:x:y:z, up:-y:y (its own axis, the scene’s), opacity:1 and hidden:1';

/**
 * For the address: the parts of a file's look that were changed, by name,
 * `move:0:1:0,turn:0:90:0,about:0.5:0:0,opacity:0.5`; nothing for a file that is drawn as it was
 * saved. Numbers are the shortest that read back as the same float64, so that the picture stays the
 * same bit for bit.
 */
export function encodeLook({ isHidden, opacity, placement }: PartLook): string {
  const parts: string[] = [];
  if (placement) {
    const { move, turnDegrees, scale, about, up, sceneUp } = placement;
    if (!isZero(move)) parts.push(`move:${move.join(':')}`);
    if (!isZero(turnDegrees)) parts.push(`turn:${turnDegrees.join(':')}`);
    if (scale !== 1) parts.push(`scale:${scale}`);
    // Only rotation and scale depend on the centre.
    if (!isZero(turnDegrees) || scale !== 1) parts.push(`about:${about.join(':')}`);
    if (up !== sceneUp) parts.push(`up:${up}:${sceneUp}`);
  }
  if (opacity !== 1) parts.push(`opacity:${opacity}`);
  if (isHidden) parts.push('hidden:1');
  return parts.join(',');
}

/**
 * Reads the text of `encodeLook`; the file completes it once it has arrived.
 *
 * @throws InvalidArgumentError naming the invalid part, and the syntax of a look.
 */
export function decodeLook(text: string): (file: PlacedFile) => PartLook {
  const parts = text.split(',').filter((part) => part !== '');
  const named = namedParts(parts, NAMES, refused);
  const change: Partial<Omit<Placement, 'about'>> = {
    ...(named.move !== undefined && { move: vectorIn('move', named.move) }),
    ...(named.turn !== undefined && { turnDegrees: vectorIn('turn', named.turn) }),
    ...(named.scale !== undefined && { scale: scaleIn(named.scale) }),
    ...(named.up !== undefined && axesIn(named.up)),
  };
  const about = named.about === undefined ? undefined : vectorIn('about', named.about);
  const opacity = named.opacity === undefined ? 1 : opacityIn(named.opacity);
  const look = { ...PLAIN_LOOK, opacity, isHidden: named.hidden === '1' };
  if (Object.keys(change).length === 0) return () => look;
  return (file) => {
    const upright = uprightPlacement(file, file.ownUp);
    const placement = changedPlacement(upright, change, file);
    return placedLook(look, about ? { ...placement, about } : placement, file);
  };
}

/** Bounds whose product fits a float32, as matrix elements must. */
const FARTHEST = 1e24;
const LARGEST_SCALE = 1e12;

const NAMES = ['move', 'turn', 'scale', 'about', 'up', 'opacity', 'hidden'];

function vectorIn(name: string, text: string): Vec3 {
  const [x, y, z, ...others] = text.split(':').map(numberIn);
  if (z === undefined || others.length > 0) throw refused(`${name}:${text} is not three numbers`);
  return [x, y, z];
}

function axesIn(text: string): { up: UpAxis; sceneUp: UpAxis } {
  const [up, sceneUp] = text.split(':').map((name) => UP_AXES.find((axis) => axis === name));
  if (!up || !sceneUp) throw refused(`up:${text} is not two of ${UP_AXES.join(', ')}`);
  return { up, sceneUp };
}

function scaleIn(text: string): number {
  const scale = numberIn(text);
  if (scale <= 0) throw refused(`scale:${text} is not above 0`);
  if (scale > LARGEST_SCALE || scale < 1 / LARGEST_SCALE)
    throw refused(`scale:${text} does not lie between ${1 / LARGEST_SCALE} and ${LARGEST_SCALE}`);
  return scale;
}

function opacityIn(text: string): number {
  const opacity = numberIn(text);
  if (opacity < 0 || opacity > 1) throw refused(`opacity:${text} does not lie between 0 and 1`);
  return opacity;
}

function numberIn(text: string): number {
  const value = numberPart(text, refused);
  if (Math.abs(value) > FARTHEST) throw refused(`${text} is not within ±${FARTHEST}`);
  return value;
}

function isZero(vector: Vec3): boolean {
  return vector.every((value) => value === 0);
}

function refused(why: string): InvalidArgumentError {
  return new InvalidArgumentError('place', `The place of a file cannot be read: ${why}; ${FORM}.`);
}
