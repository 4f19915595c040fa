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

/**
 * Places names beside their points: to the right, else left, above or below, inside `area` and clear of other names and
 * points. Null for names that find no place.
 *
 * @param points the most important first; later ones give way.
 */
export function placeLabels(points: readonly Labelled[], area: Box): (Box | null)[] {
  const taken: Box[] = points.map(({ x, y }) => ({ left: x - 4, top: y - 4, width: 8, height: 8 }));
  return points.map((point, index) => {
    const others = taken.filter((_, at) => at !== index);
    const box = placesFor(point).find(
      (place) => isInside(place, area) && !others.some((other) => isOverlapping(place, other)),
    );
    if (box) taken.push(box);
    return box ?? null;
  });
}

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

function isInside(box: Box, area: Box): boolean {
  return (
    box.left >= area.left &&
    box.top >= area.top &&
    box.left + box.width <= area.left + area.width &&
    box.top + box.height <= area.top + area.height
  );
}

function isOverlapping(a: Box, b: Box): boolean {
  return (
    a.left < b.left + b.width &&
    b.left < a.left + a.width &&
    a.top < b.top + b.height &&
    b.top < a.top + a.height
  );
}
