/** A rectangle in a chart, in pixels, y down. */
export interface LabelBox {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/** A point of a chart whose name is to stand beside it. */
export interface ChartLabel {
  readonly x: number;
  readonly y: number;
  /** Size of the name as it is written, in pixels. */
  readonly width: number;
  readonly height: number;
}

/** Half the width of a point, in pixels. */
export const POINT_RADIUS_PX = 4;
/** Between a point's middle and its name. */
const GAP_PX = POINT_RADIUS_PX + 4;

/**
 * Places names beside their points: to the right, else left, above or below, inside `area` and
 * clear of other names and points, and of `lines` if possible. Null for a name that finds no place:
 * for charts that can tell it in another way, such as by a tooltip.
 *
 * @param labels the most important first; later ones give way.
 * @param lines boxes around the lines of the chart, which would strike names through.
 */
export function placeLabels(
  labels: readonly ChartLabel[],
  area: LabelBox,
  lines: readonly LabelBox[],
): (LabelBox | null)[] {
  const space = new LabelSpace(area, labels.map(boxOf));
  const lineSpace = new LabelSpace(area, lines);
  return labels.map((label) => {
    const free = placesBeside(label).filter((place) => space.conflict(place) === 0);
    const box = free.find((place) => lineSpace.conflict(place) === 0) ?? free.at(0);
    if (box) space.take(box);
    return box ?? null;
  });
}

/** A name, with a line to its point if it stands far from it. */
export interface LedLabel {
  readonly box: LabelBox;
  /** From the point to the name: x1, y1, x2, y2; null beside the point. */
  readonly leader: readonly [number, number, number, number] | null;
}

/** Names farther away than this get a leader. */
const NEAR_PX = 14;

/**
 * Places every name, for charts on paper: the nearest place inside `area` that covers no point, no
 * other name and no line, else the one that covers least.
 *
 * @param labels the most important first; later ones give way.
 * @param lines boxes around the lines of the chart.
 */
export function placeAllLabels(
  labels: readonly ChartLabel[],
  area: LabelBox,
  lines: readonly LabelBox[],
): LedLabel[] {
  const space = new LabelSpace(area, [...lines, ...labels.map(boxOf)]);
  return labels.map((label) => {
    const { x, y } = label;
    const box = placesAround(label)
      .map((place) => ({ place, cost: 100 * space.conflict(place) + distance(place, x, y) }))
      .reduce((least, each) => (each.cost < least.cost ? each : least)).place;
    space.take(box);
    return { box, leader: distance(box, x, y) > NEAR_PX ? [x, y, ...nearest(box, x, y)] : null };
  });
}

/** None of them touches the point itself. */
function placesBeside({ x, y, width, height }: ChartLabel): LabelBox[] {
  const at = (left: number, top: number) => ({ left, top, right: left + width, bottom: top + height });
  const [middleX, middleY] = [x - width / 2, y - height / 2];
  return [
    at(x + GAP_PX, middleY),
    at(x - GAP_PX - width, middleY),
    at(middleX, y - GAP_PX - height),
    at(middleX, y + GAP_PX),
    at(x + GAP_PX / 2, y - GAP_PX / 2 - height),
    at(x - GAP_PX / 2 - width, y + GAP_PX / 2),
  ];
}

/** Right and left of the point, then above and below, farther and farther away. */
function placesAround({ x, y, width, height }: ChartLabel): LabelBox[] {
  const found: LabelBox[] = [];
  const add = (left: number, middleY: number) =>
    found.push({ left, top: middleY - height / 2, right: left + width, bottom: middleY + height / 2 });
  for (let step = 0; step <= 14; step++) {
    for (const dy of step === 0 ? [0] : [-step * height, step * height]) {
      for (const extra of [0, 24, 60, 110]) {
        add(x + GAP_PX + extra, y + dy);
        add(x - GAP_PX - extra - width, y + dy);
      }
      if (step > 0) add(x - width / 2, y + dy);
    }
  }
  return found;
}

function distance(box: LabelBox, x: number, y: number): number {
  const [nearX, nearY] = nearest(box, x, y);
  return Math.hypot(nearX - x, nearY - y);
}

function nearest({ left, top, right, bottom }: LabelBox, x: number, y: number): [number, number] {
  return [Math.max(left, Math.min(right, x)), Math.max(top, Math.min(bottom, y))];
}

/** The square around a point. */
function boxOf({ x, y }: ChartLabel): LabelBox {
  const radius = POINT_RADIUS_PX;
  return { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius };
}

/** The space for names, with the places that points, lines and names have taken. */
class LabelSpace {
  readonly #area: LabelBox;
  readonly #taken: LabelBox[];

  /** @param taken boxes that names should not cover. */
  constructor(area: LabelBox, taken: readonly LabelBox[]) {
    this.#area = area;
    this.#taken = [...taken];
  }

  take(box: LabelBox): void {
    this.#taken.push(box);
  }

  /** Area of `box` that covers taken boxes, summed over them, or lies outside; 0 if free. */
  conflict(box: LabelBox): number {
    const covered = this.#taken.reduce((sum, other) => sum + overlapArea(box, other), 0);
    const outside = (box.right - box.left) * (box.bottom - box.top) - overlapArea(box, this.#area);
    return covered + outside;
  }
}

function overlapArea(a: LabelBox, b: LabelBox): number {
  const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
  const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
  return Math.max(0, width) * Math.max(0, height);
}
