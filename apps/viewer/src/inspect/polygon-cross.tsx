import { type KeyboardEvent, useRef } from 'react';
import { useStore } from 'zustand';
import { ARROWS } from '../camera/orbit-controls.ts';
import type { PicturePoint } from '../camera/picture-space.ts';
import { pictureSpace, useOverPicture } from '../engine/show/over-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { clamp } from '../state/vec3.ts';
import type { InspectProps } from './inspection.ts';
import { withPointerAt } from './polygon.ts';
import { modeOf } from './select-drag.ts';
import { cornerGesture, drawnPolygon } from './select-gestures.ts';

const STEP_PX = 8;
/** Steps per key press with Shift. */
const LARGE_STEP = 10;
/** Half the size of the cross; the cross keeps this distance from the picture's edges. */
const HALF_PX = 12;

/** A cross over the picture, moved by keys, which sets the corners of a polygon. */
export function PolygonCross({ store, viewer, inspection }: PanelProps & InspectProps) {
  const isShown = useStore(
    store,
    ({ dock, inspecting }) =>
      dock === 'inspect' && inspecting.tab === 'select' && inspecting.selecting.tool === 'polygon',
  );
  return isShown && <Cross store={store} viewer={viewer} inspection={inspection} />;
}

function Cross({ store, viewer, inspection: { selecting } }: PanelProps & InspectProps) {
  const cross = useRef<HTMLDivElement>(null);
  /** Null until keys have moved the cross: in the centre of the area that panels leave free. */
  const moved = useRef<PicturePoint | null>(null);
  const place = (): PicturePoint => {
    const { clientWidth: width, clientHeight: height } = document.documentElement;
    const [xMiddle, yMiddle] = viewer.camera.middle;
    const [x, y] = moved.current ?? [xMiddle * width, yMiddle * height];
    return [clamp(x, HALF_PX, width - HALF_PX), clamp(y, HALF_PX, height - HALF_PX)];
  };
  const write = () => {
    const [x, y] = place();
    if (cross.current) cross.current.style.translate = `${x}px ${y}px`;
  };
  useOverPicture(store, write);
  const onKeyDown = (event: KeyboardEvent) => {
    const { key, shiftKey, ctrlKey, metaKey } = event;
    const arrow = ARROWS[key];
    const space = pictureSpace(viewer, document.documentElement);
    if (ctrlKey || metaKey || !space || (!arrow && key !== ' ')) return;
    event.preventDefault();
    // Arrow keys that bubble would turn the scene.
    event.stopPropagation();
    const [x, y] = place();
    if (!arrow) {
      cornerGesture(selecting, [x, y], space, HALF_PX).end(modeOf(event, selecting));
      return;
    }
    const step = STEP_PX * (shiftKey ? LARGE_STEP : 1);
    moved.current = [x + step * arrow[0], y + step * arrow[1]];
    moved.current = place();
    write();
    const polygon = drawnPolygon(selecting);
    if (polygon) selecting.choose({ dragged: withPointerAt(polygon, moved.current) });
  };
  return (
    <div className="over-picture">
      <div
        ref={cross}
        className="polygon-cross"
        role="application"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it takes the keys.
        tabIndex={0}
        aria-label="Corners of the polygon. Arrow keys move the cross, with Shift further; Space sets a corner, Enter closes the polygon, Backspace takes the last corner back, Escape cancels."
        data-testid="polygon-cross"
        onKeyDown={onKeyDown}
      />
    </div>
  );
}
