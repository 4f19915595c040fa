import { boxAround, type LabelBox, LabelSpace } from '@websplatter/charts';

export interface Labelled {
  readonly x: number;
  readonly y: number;
  readonly text: string;
  /** Whether it is placed before others, and set in bold. */
  readonly isFirst: boolean;
}

export interface PlacedLabel extends Omit<Labelled, 'x' | 'y'> {
  /** Start of the text, on its baseline. */
  readonly x: number;
  readonly y: number;
  /** Line from the point to a text that lies far from it: x1, y1, x2, y2. */
  readonly leader: readonly [number, number, number, number] | null;
}

const FONT_PX = 11;
/** Width of a character: a generous average of proportional fonts. */
const CHARACTER_PX = 6.1;
/** The same for labels that are placed first, which are bold. */
const BOLD_CHARACTER_PX = 6.9;
const LINE_PX = FONT_PX + 2;
const GAP_PX = 4;
/** Labels farther away than this get a leader line. */
const NEAR_PX = 14;

/**
 * Finds a place for each text beside its point: the nearest inside `area` that covers no point and
 * no other text, else the one that covers least.
 *
 * @param lines lines that labels should not cover, as thin boxes.
 */
export function placeLabels(
  points: readonly Labelled[],
  area: LabelBox,
  dotRadius: number,
  lines: readonly LabelBox[] = [],
): PlacedLabel[] {
  const space = new LabelSpace(area, [...lines, ...points.map(({ x, y }) => boxAround(x, y, dotRadius))]);
  const order = [...points].sort((a, b) => Number(b.isFirst) - Number(a.isFirst));
  return order.map(({ x, y, text, isFirst }) => {
    const width = (isFirst ? BOLD_CHARACTER_PX : CHARACTER_PX) * text.length;
    const best = places(x, y, width, dotRadius)
      .map((box) => ({ box, cost: cost(box, x, y, space) }))
      .reduce((least, each) => (each.cost < least.cost ? each : least)).box;
    space.take(best);
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

/** Places to try: right and left of the point, then above and below, farther and farther away. */
function places(x: number, y: number, width: number, dotRadius: number): LabelBox[] {
  const found: LabelBox[] = [];
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

function cost(box: LabelBox, x: number, y: number, space: LabelSpace): number {
  const [nearX, nearY] = nearest(box, x, y);
  return 100 * space.conflict(box) + Math.hypot(nearX - x, nearY - y);
}

function nearest({ left, top, right, bottom }: LabelBox, x: number, y: number): [number, number] {
  return [Math.max(left, Math.min(right, x)), Math.max(top, Math.min(bottom, y))];
}
