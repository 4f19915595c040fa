import { openFrameWriter } from '@websplatter/core/write';
import { GOLDEN_RATIO, hash, type SceneSplat, splatsOf } from './splats.ts';

const FRAMES = 24;
const FRAMES_PER_S = 24;
/** Rows of feathers from the body to the tip of a wing, and splats of each from front to back. */
const ROWS = 46;
const FEATHERS = 26;
const WING = ROWS * FEATHERS;
const BODY = 1_300;
const TAIL = 240;
const SPAN = 0.62;

/** A bird in flight whose wings beat once, as one file of frames. */
export async function birdFrames(): Promise<Uint8Array> {
  const writer = await openFrameWriter({ framesPerS: FRAMES_PER_S });
  for (let frame = 0; frame < FRAMES; frame++) {
    const phase = (2 * Math.PI * frame) / FRAMES;
    await writer.add(splatsOf(2 * WING + BODY + TAIL, (i) => birdSplat(i, phase)));
  }
  const parts: Uint8Array<ArrayBuffer>[] = [];
  await writer.finish(async (bytes) => void parts.push(bytes));
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

function birdSplat(i: number, phase: number): SceneSplat {
  // The body sinks as the wings go up.
  const lift = -0.045 * Math.sin(phase);
  const splat = i < 2 * WING ? wing(i, phase) : i < 2 * WING + BODY ? body(i - 2 * WING) : tail(i);
  const [x, y, z] = splat.position;
  return { ...splat, position: [x, y + lift, z] };
}

/** Wings bend: their tips follow a quarter of a beat behind. The bird flies along x. */
function wing(i: number, phase: number): SceneSplat {
  const side = i < WING ? 1 : -1;
  const [row, feather] = [Math.floor((i % WING) / FEATHERS), i % FEATHERS];
  let [y, out, angle] = [0.03, 0.05, 0];
  for (let each = 0; each <= row; each++) {
    const share = each / ROWS;
    angle = 0.15 + 0.85 * Math.sin(phase - 1.5 * share) * (0.55 + 0.45 * share);
    y += (SPAN / ROWS) * Math.sin(angle);
    out += (SPAN / ROWS) * Math.cos(angle);
  }
  const share = (row + 0.5) / ROWS;
  const chord = 0.26 * (1 - 0.75 * share ** 2.2);
  const back = (feather + 0.5) / FEATHERS;
  const x = 0.1 - 0.16 * share ** 2 - chord * (back - 0.2);
  const isTip = share > 0.72 || back > 0.8;
  const light = 0.75 + 0.3 * Math.cos(angle) * (1 - back) + 0.12 * hash(row);
  const color = isTip ? [0.08, 0.14, 0.3] : back > 0.45 ? [0.1, 0.4, 0.72] : [0.2, 0.66, 0.86];
  return {
    position: [x, y - 0.03 * back, side * out],
    scale: [chord / FEATHERS, 0.003, SPAN / ROWS / 1.5],
    axis: [0, Math.cos(angle), -side * Math.sin(angle)],
    color: color.map((value) => value * light),
    opacityLogit: 3,
  };
}

/** Blue above and orange below, with a white throat and a dark beak. */
function body(i: number): SceneSplat {
  const along = 2 * ((i + 0.5) / BODY) - 1;
  const around = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
  const isHead = along > 0.48;
  const isBeak = along > 0.84;
  const bulge = Math.sqrt(Math.max(0, 1 - along ** 2));
  const radius = isBeak ? 0.09 * (1 - along) : 0.085 * bulge + (isHead ? 0.015 : 0);
  const [up, side] = [Math.cos(around), Math.sin(around)];
  const light = 0.78 + 0.26 * up;
  const isEye = isHead && !isBeak && Math.abs(along - 0.68) < 0.045 && Math.abs(up - 0.35) < 0.22;
  const color =
    isBeak || isEye
      ? [0.1, 0.1, 0.12]
      : up > 0.15
        ? [0.14, 0.5, 0.8]
        : isHead && up > -0.45
          ? [0.97, 0.95, 0.9]
          : [0.95, 0.5, 0.16];
  return {
    position: [
      0.27 * along + (isBeak ? 0.35 * (along - 0.84) : 0),
      radius * up + (isHead ? 0.025 : 0),
      radius * side,
    ],
    scale: isBeak ? 0.005 : 0.011,
    color: color.map((value) => value * light),
    opacityLogit: 3,
  };
}

function tail(i: number): SceneSplat {
  const share = (i % 40) / 40;
  const fan = (Math.floor(i / 40) % 6) / 5 - 0.5;
  return {
    position: [-0.24 - 0.22 * share, 0.005 - 0.02 * share, fan * (0.05 + 0.14 * share)],
    scale: [0.008, 0.003, 0.006 + 0.008 * share],
    color: [0.1, 0.34, 0.62].map((value) => value * (1.15 - 0.5 * share)),
    opacityLogit: 3,
  };
}
