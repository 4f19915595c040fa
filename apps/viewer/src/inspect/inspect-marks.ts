import type { FrameRequest } from '@websplatter/core';
import { type TracedSplat, traceSplat } from '@websplatter/core/reference';
import { shallow } from 'zustand/vanilla/shallow';
import { flippedPoint } from '../camera/flip.ts';
import {
  boxOutline,
  circleOutline,
  lineInPicture,
  type PicturePoint,
  type PictureSpace,
  pathInPicture,
  pictureOf,
  rowOf,
} from '../camera/picture-space.ts';
import type { ShownFrame, Viewer } from '../engine/viewer.ts';
import type { LengthScale, Ruler } from '../state/inspecting.ts';
import type { DragRegion, PickedRegion, Selecting } from '../state/selecting.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { Vec3 } from '../state/vec3.ts';
import { formatLength } from './length-scale.ts';
import { cornersOf } from './polygon.ts';
import { rulerLength } from './rulers.ts';

/**
 * Draws the inspection into `svg`, over the image: the splat's ellipse, the crop's box and the
 * dragged region while their tab is open, and rulers always. Updated with each frame. Returns a
 * function that stops this.
 */
export function drawInspectMarks(svg: SVGSVGElement, viewer: Viewer, store: ViewerStore): () => void {
  const draw = () => {
    const state = store.getState();
    const { shownFrame: shown } = viewer;
    const isEmpty = state.dock !== 'inspect' && state.inspecting.rulers.length === 0;
    svg.toggleAttribute('hidden', isEmpty || !shown);
    if (isEmpty || !shown) return;
    const space = { camera: shown.frame.camera, width: svg.clientWidth, height: svg.clientHeight };
    svg.replaceChildren(...marksOf(state, shown, space));
  };
  draw();
  const unsubscribe = store.subscribe(
    ({ shownFrames, inspecting, dock, restedFrames }) => [shownFrames, inspecting, dock, restedFrames],
    draw,
    { equalityFn: shallow },
  );
  return () => {
    unsubscribe();
    svg.replaceChildren();
  };
}

function marksOf(state: ViewerState, { frame, isFlipped }: ShownFrame, space: PictureSpace): SVGElement[] {
  const world = (point: Vec3) => (isFlipped ? flippedPoint(point) : point);
  const ofTab = state.dock === 'inspect' ? tabMarks(state, frame, space, world) : [];
  return [...rulerMarks(state.inspecting.rulers, state.inspecting.scale, space, world), ...ofTab];
}

function tabMarks(
  state: ViewerState,
  frame: ShownFrame['frame'],
  space: PictureSpace,
  world: (point: Vec3) => Vec3,
): SVGElement[] {
  const { crop, tab, rulerStart, selecting } = state.inspecting;
  switch (tab) {
    case 'splat':
      return splatMarks(state, frame, space.width);
    case 'distance':
      return rulerStart ? dotsAt([rulerStart], space, world) : [];
    case 'crop':
      return crop ? linesOf('box', space, boxOutline(crop.min, crop.max), world) : [];
    case 'select':
      return selectMarks(selecting, space, world);
    case 'histogram':
      return [];
  }
}

function splatMarks({ inspecting, accuracy }: ViewerState, frame: FrameRequest, width: number): SVGElement[] {
  const { splat } = inspecting;
  const cloud = splat && frame.clouds[splat.cloudIndex];
  if (!splat?.set || !cloud) return [];
  const { alphaCutoff } = accuracy;
  const seen = traceSplat(splat.set, 0, { ...frame, modelMatrix: cloud.modelMatrix, alphaCutoff });
  return seen ? ellipseOf(seen, width / frame.widthPx) : [];
}

/** A transformed circle, whose stroke has the same width everywhere. */
function ellipseOf({ centerPx, majorPx, minorPx }: TracedSplat, cssPerPx: number): SVGElement[] {
  const values = [...majorPx, ...minorPx, ...centerPx].map((px) => (px * cssPerPx).toFixed(2));
  const transform = `matrix(${values.join(' ')})`;
  return ['halo', 'line'].map((layer) => element('circle', { class: `mark-${layer}`, r: '1', transform }));
}

function rulerMarks(
  rulers: readonly Ruler[],
  lengthScale: LengthScale | null,
  space: PictureSpace,
  world: (point: Vec3) => Vec3,
): SVGElement[] {
  if (rulers.length === 0) return [];
  const labels = rulers.flatMap((ruler) => {
    const line = lineInPicture(space, world(ruler.ends[0]), world(ruler.ends[1]));
    return line ? [labelOf(line, formatLength(rulerLength(ruler), lengthScale))] : [];
  });
  const lines = rulers.map(({ ends }) => ends);
  return [...linesOf('ruler', space, lines, world), ...dotsAt(lines.flat(), space, world), ...labels];
}

function dotsAt(points: readonly Vec3[], space: PictureSpace, world: (point: Vec3) => Vec3): SVGElement[] {
  return points
    .map((point) => pictureOf(space, world(point)))
    .filter((place) => place !== null)
    .map((place) => dotAt(place, 4));
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

function dotAt([x, y]: PicturePoint, radiusPx: number): SVGElement {
  return element('circle', { class: 'mark-dot', cx: x.toFixed(1), cy: y.toFixed(1), r: String(radiusPx) });
}

function selectMarks(
  { dragged, picked, tool }: Selecting,
  space: PictureSpace,
  world: (point: Vec3) => Vec3,
): SVGElement[] {
  if (dragged) return regionMarks(dragged);
  return picked?.kind === 'sphere' && tool === 'sphere' ? sphereMarks(picked, space, world) : [];
}

/** Outline of a sphere as a circle that faces the camera, and its radius. */
function sphereMarks(
  { center, radius }: Extract<PickedRegion, { kind: 'sphere' }>,
  space: PictureSpace,
  world: (point: Vec3) => Vec3,
): SVGElement[] {
  const [right, up] = [0, 1].map((row) => rowOf(space.camera.viewMatrix, row));
  const middle = world(center);
  const circle = circleOutline(middle, right, up, radius);
  const place = pictureOf(space, middle);
  return [
    ...linesOf('sphere', space, [circle], (point) => point),
    ...(place ? [dotAt(place, 4), labelOf([place, place], formatLength(radius, null))] : []),
  ];
}

function regionMarks(dragged: DragRegion): SVGElement[] {
  if (dragged.kind === 'brush') {
    const { points, radius } = dragged;
    // A line of zero length still has round caps.
    const d = `M${points[0]} ${points[1]}L${points.join(' ')}`;
    return [
      element('path', { class: 'mark-brush', 'data-mark': 'region', d, 'stroke-width': String(2 * radius) }),
    ];
  }
  if (dragged.kind === 'polygon') {
    const corners = cornersOf(dragged);
    const dots = corners.flatMap((x, i) => (i % 2 ? [] : [dotAt([x, corners[i + 1]], i ? 4 : 6)]));
    return [...areaMarks(`M${dragged.points.join(' ')}Z`), ...dots];
  }
  const { from, to } = dragged;
  return areaMarks(`M${from[0]} ${from[1]}H${to[0]}V${to[1]}H${from[0]}Z`);
}

function areaMarks(d: string): SVGElement[] {
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
