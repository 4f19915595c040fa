export interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

export interface Labelled {
  readonly x: number;
  readonly y: number;
  readonly text: string;
  /** Whether it takes its place before others do. */
  readonly isFirst: boolean;
}

export interface PlacedLabel extends Omit<Labelled, 'x' | 'y'> {
  /** Where the text begins, on its base line. */
  readonly x: number;
  readonly y: number;
  /** From the point to the text, where they lie apart: x1, y1, x2, y2. */
  readonly leader: readonly [number, number, number, number] | null;
}

const FONT_PX = 11;
/** A generous average of proportional fonts. */
const CHARACTER_PX = 6.1;
/** What takes its place first is bold. */
const BOLD_CHARACTER_PX = 6.9;
const LINE_PX = FONT_PX + 2;
const GAP_PX = 4;
/** Beyond this a line leads to the label. */
const NEAR_PX = 14;

/**
 * A place for each text beside its point: the nearest in which it covers no point, no other text and does not leave
 * `area`; where there is none, the one that covers least.
 *
 * @param lines what else is better not covered, as thin boxes.
 */
export function placeLabels(
  points: readonly Labelled[],
  area: Box,
  dotRadius: number,
  lines: readonly Box[] = [],
): PlacedLabel[] {
  const taken: Box[] = [...lines, ...points.map(({ x, y }) => around(x, y, dotRadius))];
  const order = [...points].sort((a, b) => Number(b.isFirst) - Number(a.isFirst));
  return order.map(({ x, y, text, isFirst }) => {
    const width = (isFirst ? BOLD_CHARACTER_PX : CHARACTER_PX) * text.length;
    const best = places(x, y, width, dotRadius)
      .map((box) => ({ box, cost: cost(box, x, y, taken, area) }))
      .reduce((least, each) => (each.cost < least.cost ? each : least)).box;
    taken.push(best);
    const [nearX, nearY] = nearest(best, x, y);
    const isFar = Math.hypot(nearX - x, nearY - y) > NEAR_PX;
    return {
      x: best.left,
      y: best.bottom - 3,
      text,
      isFirst,
      leader: isFar ? [x, y, nearX, nearY] : null,
    };
  });
}

/** Right and left of the point, then above and below, ever farther away. */
function places(x: number, y: number, width: number, dotRadius: number): Box[] {
  const found: Box[] = [];
  const add = (left: number, middleY: number) =>
    found.push({ left, top: middleY - LINE_PX / 2, right: left + width, bottom: middleY + LINE_PX / 2 });
  for (let step = 0; step <= 14; step++) {
    for (const dy of step === 0 ? [0] : [-step * LINE_PX, step * LINE_PX]) {
      for (const extra of [0, 24, 60, 110]) {
        add(x + dotRadius + GAP_PX + extra, y + dy);
        add(x - dotRadius - GAP_PX - extra - width, y + dy);
      }
      if (step > 0) add(x - width / 2, y + dy);
    }
  }
  return found;
}

function cost(box: Box, x: number, y: number, taken: readonly Box[], area: Box): number {
  const covered = taken.reduce((sum, other) => sum + overlapArea(box, other), 0);
  const width = box.right - box.left;
  const outside = width * LINE_PX - overlapArea(box, area);
  const [nearX, nearY] = nearest(box, x, y);
  return 100 * (covered + outside) + Math.hypot(nearX - x, nearY - y);
}

function nearest({ left, top, right, bottom }: Box, x: number, y: number): [number, number] {
  return [Math.max(left, Math.min(right, x)), Math.max(top, Math.min(bottom, y))];
}

function overlapArea(a: Box, b: Box): number {
  const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
  const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
  return Math.max(0, width) * Math.max(0, height);
}

function around(x: number, y: number, radius: number): Box {
  return { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius };
}
