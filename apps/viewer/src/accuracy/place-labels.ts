import { boxAround, type LabelBox, LabelSpace } from '@websplatter/charts';

/** A rectangle, CSS pixels, y down. */
export interface Box {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/** A point of a chart that is to have its name beside it. */
export interface Labelled {
  readonly x: number;
  readonly y: number;
  /** Size of the name as it is written. */
  readonly width: number;
  readonly height: number;
}

/** Between a point's middle and its name. */
const GAP_PX = 8;
/** Half the width of a point. */
const POINT_PX = 4;

/**
 * Places names beside their points: to the right, else left, above or below, inside `area` and
 * clear of other names and points, and of `lines` if they can be. Null for names that find no
 * place.
 *
 * @param points the most important first; later ones give way.
 * @param lines boxes around the lines of the chart, which would strike names through.
 */
export function placeLabels(
  points: readonly Labelled[],
  area: Box,
  lines: readonly Box[] = [],
): (Box | null)[] {
  const marks = points.map(({ x, y }) => boxAround(x, y, POINT_PX));
  const space = new LabelSpace(edgesOf(area), marks);
  const lineSpace = new LabelSpace(edgesOf(area), lines.map(edgesOf));
  return points.map((point) => {
    const free = placesFor(point).filter((place) => space.conflict(edgesOf(place)) === 0);
    const box = free.find((place) => lineSpace.conflict(edgesOf(place)) === 0) ?? free.at(0);
    if (box) space.take(edgesOf(box));
    return box ?? null;
  });
}

/** None of them touches the point itself. */
function placesFor({ x, y, width, height }: Labelled): Box[] {
  const size = { width, height };
  const [middleX, middleY] = [x - width / 2, y - height / 2];
  return [
    { left: x + GAP_PX, top: middleY, ...size },
    { left: x - GAP_PX - width, top: middleY, ...size },
    { left: middleX, top: y - GAP_PX - height, ...size },
    { left: middleX, top: y + GAP_PX, ...size },
    { left: x + GAP_PX / 2, top: y - GAP_PX / 2 - height, ...size },
    { left: x - GAP_PX / 2 - width, top: y + GAP_PX / 2, ...size },
  ];
}

function edgesOf({ left, top, width, height }: Box): LabelBox {
  return { left, top, right: left + width, bottom: top + height };
}
