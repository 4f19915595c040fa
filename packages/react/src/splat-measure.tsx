import { useFrame, useStore, useThree } from '@react-three/fiber';
import { callListener, InvalidArgumentError } from '@websplatter/core';
import { findSplatEngine, pickSplat } from '@websplatter/three';
import { type ReactNode, useEffect, useLayoutEffect, useRef } from 'react';
import type { WebGPURenderer } from 'three/webgpu';
import { isServer } from './is-server.ts';
import { type Measurement, MeasureTool, type MeasureUnit } from './measure-tool.ts';
import { placeOnCanvas } from './place-on-canvas.ts';
import { useLatest } from './stable-values.ts';
import { rendererOf, useMeasuredRenderer } from './use-renderer.ts';

/** Props of `<SplatMeasure>`. */
export interface SplatMeasureProps {
  /**
   * Unit and format of distances: `{ name: 'm', perWorldUnit: 1, digits: 2 }`; default world units,
   * with two decimal places.
   */
  unit?: MeasureUnit;
  /** Called when a second point has been set. */
  onMeasure?: (measurement: Measurement) => void;
}

/**
 * Measures the distance between two splats, chosen by clicks, or by arrow keys and Enter when the
 * canvas has the focus. The GPU finds the splat under the pointer as `pick` does; meshes are not
 * measured. A third point begins a new measurement; Escape clears it, Backspace removes the last
 * point. Drags are not clicks, so camera controls keep working.
 *
 * @throws InvalidArgumentError outside of a Canvas, and for a unit with a scale or digits out of
 *   range; SplatsUnsupportedRendererError in a Canvas whose renderer cannot draw splats.
 * @example
 * <SplatCanvas flat>
 *   <Splats src="/garden.ply" />
 *   <SplatMeasure unit={{ name: 'cm', perWorldUnit: 100, digits: 0 }} />
 * </SplatCanvas>
 */
export function SplatMeasure(props: SplatMeasureProps): ReactNode {
  const { perWorldUnit = 1, digits = 2 } = props.unit ?? {};
  if (!(perWorldUnit > 0 && perWorldUnit < Number.POSITIVE_INFINITY)) {
    const message = `perWorldUnit is ${perWorldUnit}; it must be the number of units in one world unit, above 0.`;
    throw new InvalidArgumentError('unit', message);
  }
  if (!(Number.isInteger(digits) && digits >= 0 && digits <= 20)) {
    throw new InvalidArgumentError('unit', `digits is ${digits}; it must be a whole number from 0 to 20.`);
  }
  const isOnServer = isServer();
  const renderer = useMeasuredRenderer(isOnServer ? [null] : [], '<SplatMeasure>');
  // Fails for renderers that draw no splats.
  if (renderer) findSplatEngine(renderer);
  return isOnServer ? null : <Measure {...props} />;
}

function Measure({ unit = {}, onMeasure }: SplatMeasureProps): ReactNode {
  const store = useStore();
  const invalidate = useThree((state) => state.invalidate);
  const latest = useLatest({ unit, onMeasure });
  const tool = useRef<MeasureTool>(null);
  useLayoutEffect(() => {
    const made = new MeasureTool({
      canvas: store.getState().gl.domElement,
      pick: async (x, y) => {
        const state = store.getState();
        const renderer = rendererOf(state) as WebGPURenderer;
        const [xPx, yPx] = [x, y].map((distance) => Math.floor(distance * renderer.getPixelRatio()));
        return (await pickSplat(renderer, state.scene, state.camera, xPx, yPx))?.point ?? null;
      },
      project: (point) => {
        const { camera, size } = store.getState();
        const place = placeOnCanvas(point, camera, size);
        return place && [place.x, place.y];
      },
      unit: () => latest.current.unit,
      onMeasure: (measurement) => callListener(latest.current.onMeasure, measurement),
    });
    tool.current = made;
    return () => made.remove();
  }, [store, latest]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: a frame shows another unit.
  useEffect(() => invalidate(), [invalidate, unit.name, unit.perWorldUnit, unit.digits]);
  // After the frame has updated the matrices, and before the browser paints.
  useFrame(() => queueMicrotask(() => tool.current?.draw()));
  return null;
}
