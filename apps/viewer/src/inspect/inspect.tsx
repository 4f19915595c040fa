import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { CropHandles } from './crop-handles.tsx';
import { drawInspectMarks } from './inspect-marks.ts';
import './inspect-marks.css';
import { InspectPanel } from './inspect-panel.tsx';
import { Inspection } from './inspection.ts';
import { PolygonCross } from './polygon-cross.tsx';

/** The panel that inspects, and its marks over the image. A crop goes on without the panel. */
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
