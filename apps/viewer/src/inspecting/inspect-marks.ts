import { type TracedSplat, traceSplat } from '@websplatter/core/reference';
import { flippedPoint } from '../camera/flip.ts';
import {
  boxOutline,
  lineInPicture,
  type PictureSpace,
  pathInPicture,
  pictureOf,
} from '../camera/picture-space.ts';
import type { Vec3 } from '../camera/vec3.ts';
import type { DragRegion } from '../state/selecting.ts';
import type { ViewerStore } from '../state/store.ts';
import type { ViewerState } from '../state/viewer-state.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { formatLength } from './length-scale.ts';
import { rulerLength } from './rulers.ts';

/**
 * Draws the inspection over the image, into `svg`: the ellipse of the splat, rulers, the box of the
 * crop, the area of a drag. It follows the camera with each frame. Returns a function that stops
 * this.
 */
export function drawInspectMarks(svg: SVGSVGElement, viewer: Viewer, store: ViewerStore): () => void {
  const draw = () => {
    const state = store.getState();
    const frame = viewer.shownFrame?.frame;
    svg.toggleAttribute('hidden', state.dock !== 'inspect' || !frame);
    if (state.dock !== 'inspect' || !frame) return;
    const space = { camera: frame.camera, width: svg.clientWidth, height: svg.clientHeight };
    svg.replaceChildren(...marksOf(state, frame, space));
  };
  draw();
  const unsubscribe = store.subscribe((state, before) => {
    const isOther =
      state.lastRender !== before.lastRender ||
      state.inspecting !== before.inspecting ||
      state.dock !== before.dock ||
      state.restedFrames !== before.restedFrames;
    if (isOther) draw();
  });
  return () => {
    unsubscribe();
    svg.replaceChildren();
  };
}

type ShownCamera = NonNullable<Viewer['shownFrame']>['frame'];

function marksOf(state: ViewerState, frame: ShownCamera, space: PictureSpace): SVGElement[] {
  const { inspecting, isFlipped } = state;
  const world = (point: Vec3) => (isFlipped ? flippedPoint(point) : point);
  switch (inspecting.tab) {
    case 'splat':
      return splatMarks(state, frame, space.width);
    case 'distance':
      return rulerMarks(state, space, world);
    case 'crop':
      if (!inspecting.crop) return [];
      return linesOf('box', space, boxOutline(inspecting.crop.min, inspecting.crop.max), world);
    case 'select':
      return inspecting.selecting.dragged ? regionMarks(inspecting.selecting.dragged) : [];
    case 'histogram':
      return [];
  }
}

function splatMarks({ inspecting, accuracy }: ViewerState, frame: ShownCamera, width: number): SVGElement[] {
  const { splat } = inspecting;
  const cloud = splat && frame.clouds[splat.cloudIndex];
  if (!splat?.set || !cloud) return [];
  const { alphaCutoff } = accuracy;
  const seen = traceSplat(splat.set, 0, { ...frame, modelMatrix: cloud.modelMatrix, alphaCutoff });
  return seen ? ellipseOf(seen, width / frame.widthPx) : [];
}

/** A circle under a matrix, so that its line is as wide everywhere. */
function ellipseOf({ centerPx, majorPx, minorPx }: TracedSplat, cssPerPx: number): SVGElement[] {
  const values = [...majorPx, ...minorPx, ...centerPx].map((px) => (px * cssPerPx).toFixed(2));
  const transform = `matrix(${values.join(' ')})`;
  return ['halo', 'line'].map((layer) => element('circle', { class: `mark-${layer}`, r: '1', transform }));
}

function rulerMarks(
  { inspecting }: ViewerState,
  space: PictureSpace,
  world: (point: Vec3) => Vec3,
): SVGElement[] {
  const { rulers, rulerStart, scale } = inspecting;
  const points = [...rulers.flatMap(({ ends }) => ends), ...(rulerStart ? [rulerStart] : [])];
  const dots = points
    .map((point) => pictureOf(space, world(point)))
    .filter((place) => place !== null)
    .map(([x, y]) => element('circle', { class: 'mark-dot', cx: x.toFixed(1), cy: y.toFixed(1), r: '4' }));
  const labels = rulers.flatMap((ruler) => {
    const line = lineInPicture(space, world(ruler.ends[0]), world(ruler.ends[1]));
    return line ? [labelOf(line, formatLength(rulerLength(ruler), scale))] : [];
  });
  const lines = rulers.map(({ ends }) => ends);
  return [...linesOf('ruler', space, lines, world), ...dots, ...labels];
}

function labelOf(
  [[x1, y1], [x2, y2]]: NonNullable<ReturnType<typeof lineInPicture>>,
  text: string,
): SVGElement {
  const label = element('text', {
    class: 'mark-label',
    x: ((x1 + x2) / 2).toFixed(1),
    y: ((y1 + y2) / 2 - 8).toFixed(1),
  });
  label.textContent = text;
  return label;
}

function regionMarks(dragged: DragRegion): SVGElement[] {
  if (dragged.kind === 'brush') {
    const { points, radius } = dragged;
    // A line of no length has round ends too.
    const d = `M${points[0]} ${points[1]}L${points.join(' ')}`;
    return [
      element('path', { class: 'mark-brush', 'data-mark': 'region', d, 'stroke-width': String(2 * radius) }),
    ];
  }
  const { from, to } = dragged;
  const d = `M${from[0]} ${from[1]}H${to[0]}V${to[1]}H${from[0]}Z`;
  return ['halo', 'line', 'region'].map((layer) =>
    element('path', { class: `mark-${layer}`, 'data-mark': 'region', d }),
  );
}

/** White over dark: visible on every image. */
function linesOf(
  name: string,
  space: PictureSpace,
  lines: readonly (readonly Vec3[])[],
  world: (point: Vec3) => Vec3,
): SVGElement[] {
  const d = pathInPicture(
    space,
    lines.map((points) => points.map(world)),
  );
  return ['halo', 'line'].map((layer) => element('path', { class: `mark-${layer}`, 'data-mark': name, d }));
}

function element(name: string, attributes: Readonly<Record<string, string>>): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}
