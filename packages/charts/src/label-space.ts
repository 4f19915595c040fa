/** A rectangle in a chart, y down. */
export interface LabelBox {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/**
 * The space for labels in a chart, with the places that points, lines and labels have taken. Each
 * chart has its own places to try and its own way to choose among them; this class computes what a
 * place would cover.
 */
export class LabelSpace {
  readonly #area: LabelBox;
  readonly #taken: LabelBox[];

  /**
   * @param area where labels may lie.
   * @param taken boxes that labels should not cover.
   */
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

/** The square around a point. */
export function boxAround(x: number, y: number, radius: number): LabelBox {
  return { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius };
}

function overlapArea(a: LabelBox, b: LabelBox): number {
  const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
  const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
  return Math.max(0, width) * Math.max(0, height);
}
