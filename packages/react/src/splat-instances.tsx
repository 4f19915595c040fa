import { useThree } from '@react-three/fiber';
import { InvalidArgumentError } from '@websplatter/core';
import { SplatInstances as Instances } from '@websplatter/three';
import { type ReactNode, useLayoutEffect, useMemo } from 'react';
import { Color, SRGBColorSpace } from 'three';
import { colorInEngine, type SplatColor } from './effect-props.ts';
import { Splats, type SplatsProps } from './splats.tsx';

/** Props of `<SplatInstances>`: props of `<Splats>` for all instances, and lists with one entry each. */
export interface SplatInstancesProps extends Omit<SplatsProps, 'instances'> {
  /**
   * Number of instances; default: the number of `matrices`. Another number makes all of them anew.
   */
  count?: number;
  /**
   * A matrix for each instance, relative to the object: 16 numbers, column-major. Alternatively, set
   * the matrices of `ref.current.instances`.
   */
  matrices?: ArrayLike<number>;
  /** A colour for each instance, multiplied by `tint`. */
  tints?: readonly SplatColor[];
  /** An opacity in 0…1 for each instance, multiplied by `opacity`. */
  opacities?: ArrayLike<number>;
}

/**
 * Shows splats many times, as an InstancedMesh shows a mesh: with one upload, and sorted together
 * with all other splats. Matrices, colours and opacities may change in every frame, without a render
 * of React: `ref.current.instances.setMatrixAt(…)`.
 *
 * @throws InvalidArgumentError for lists of other lengths, and as `<Splats>` does.
 * @example
 * const matrices = [0, 2, 4].flatMap((x) => new Matrix4().makeTranslation(x, 0, 0).elements);
 *
 * <SplatCanvas flat>
 *   <SplatInstances src="/robot.ply" matrices={matrices} tints={['red', 'lime', 'blue']} />
 * </SplatCanvas>
 */
export function SplatInstances({
  matrices,
  count = matrices ? matrices.length / 16 : 0,
  tints,
  opacities,
  ...props
}: SplatInstancesProps): ReactNode {
  const lists = { matrices: [matrices, 16], tints: [tints, 1], opacities: [opacities, 1] } as const;
  for (const [name, [list, each]] of Object.entries(lists)) {
    if (!list || list.length === each * count) continue;
    const message = `${name} has ${list.length} values; ${count} instances take ${each} each.`;
    throw new InvalidArgumentError(name, message);
  }
  const instances = useMemo(() => new Instances(count), [count]);
  const invalidate = useThree((state) => state.invalidate);
  useLayoutEffect(() => {
    if (!matrices) return;
    instances.matrices.set(matrices);
    instances.needsUpdate = true;
    invalidate();
  }, [instances, matrices, invalidate]);
  useLayoutEffect(() => {
    if (!tints) return;
    for (const [i, tint] of tints.entries())
      instances.setColorAt(i, new Color().setRGB(...colorInEngine(tint), SRGBColorSpace));
    invalidate();
    return () => {
      instances.colors = null;
    };
  }, [instances, tints, invalidate]);
  useLayoutEffect(() => {
    if (!opacities) return;
    instances.opacities = Float32Array.from(opacities);
    invalidate();
    return () => {
      instances.opacities = null;
    };
  }, [instances, opacities, invalidate]);
  return <Splats {...props} instances={instances} />;
}
