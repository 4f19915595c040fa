/** Content of the picture; the first is the picture as the scene was trained. */
export const VIEW_MODE_NAMES = [
  'colours',
  'ellipsoids',
  'centres',
  'depth',
  'opacity',
  'harmonics',
  'overdraw',
  'detail',
  'tile-cost',
  'pixel-cost',
  'contribution',
] as const;

export type ViewModeName = (typeof VIEW_MODE_NAMES)[number];

/** Modes that lay a map over the picture once it is at rest, and draw no effects. */
export type MapModeName = Extract<ViewModeName, 'tile-cost' | 'pixel-cost' | 'contribution'>;

export function isMapMode(name: ViewModeName): name is MapModeName {
  return VIEW_MODE_NAMES.indexOf(name) >= VIEW_MODE_NAMES.indexOf('tile-cost');
}

/** The mode `steps` further in the list, which begins again behind its end. */
export function viewModeAfter(name: ViewModeName, steps: number): ViewModeName {
  const count = VIEW_MODE_NAMES.length;
  return VIEW_MODE_NAMES[(VIEW_MODE_NAMES.indexOf(name) + steps + count) % count];
}
