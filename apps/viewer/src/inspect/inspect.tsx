import './inspect.css';
import { stepFor } from '@websplatter/kit/nice-steps';
import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { AxisHandles } from '../scene/axis-handles.tsx';
import { faceMiddle, withSide } from './cropping.ts';
import { drawInspectMarks } from './inspect-marks.ts';
import { InspectPanel } from './inspect-panel.tsx';
import { Inspection, type InspectProps } from './inspection.ts';
import { PolygonCross } from './polygon-cross.tsx';

const ARM_PX = 32;

const HANDLES = [0, 1, 2].flatMap((axis) => {
  const name = 'xyz'[axis];
  return [
    { axis, side: -1, end: 'min', label: `Min ${name} of the crop`, testId: `crop-handle-min-${name}` },
    { axis, side: 1, end: 'max', label: `Max ${name} of the crop`, testId: `crop-handle-max-${name}` },
  ] as const;
});

/** Handles over the picture for the faces of the crop's box, while the crop tab is open. */
function CropHandles({ store, viewer, inspection }: PanelProps & InspectProps) {
  const crop = useStore(store, ({ dock, inspecting }) =>
    dock === 'inspect' && inspecting.tab === 'crop' ? inspecting.crop : null,
  );
  if (!crop) return null;
  const { cropping } = inspection;
  return (
    <AxisHandles
      store={store}
      viewer={viewer}
      handles={HANDLES}
      armPx={ARM_PX}
      testId="crop-handles"
      placeOf={({ axis, end }) => ({ foot: faceMiddle(crop, end, axis), value: crop[end][axis] })}
      step={stepFor(2 * cropping.place.radius)}
      onMove={({ axis, end }, value, drag) => cropping.set(withSide(crop, end, axis, value), drag)}
    />
  );
}

/** The panel Inspect and its marks over the image. Crop and rulers stay when the panel closes. */
export function Inspect({ store, viewer }: PanelProps) {
  const isOpen = useStore(store, (state) => state.dock === 'inspect');
  const inspection = useMemo(() => new Inspection(viewer, store), [viewer, store]);
  const svg = useRef<SVGSVGElement>(null);
  useEffect(() => inspection.watch(), [inspection]);
  useEffect(() => (svg.current ? drawInspectMarks(svg.current, viewer, store) : undefined), [viewer, store]);
  return (
    <>
      <svg ref={svg} className="over-picture inspect-marks" aria-hidden="true" data-testid="inspect-marks" />
      <CropHandles store={store} viewer={viewer} inspection={inspection} />
      <PolygonCross store={store} viewer={viewer} inspection={inspection} />
      {isOpen && <InspectPanel store={store} inspection={inspection} />}
    </>
  );
}
