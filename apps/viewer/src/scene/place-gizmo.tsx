import { useStore } from 'zustand';
import { placedMiddle, placementOf } from '../engine/open/placement.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { AxisHandles } from './axis-handles.tsx';
import { movePart, moveStep } from './edit-parts.ts';
import { selectedPartOf } from './selected-part.ts';

const ARM_PX = 84;

/** Three handles over the picture that move the chosen file along the scene's axes. */
export function PlaceGizmo({ store, viewer }: PanelProps) {
  const part = useStore(store, selectedPartOf);
  if (!part?.canPlace || part.look.isHidden) return null;
  const placement = placementOf(part);
  return (
    <AxisHandles
      store={store}
      viewer={viewer}
      handles={[0, 1, 2].map((axis) => ({
        axis,
        side: 1,
        label: `Move ${part.title} along ${'xyz'[axis]}`,
        testId: `gizmo-${'xyz'[axis]}`,
      }))}
      armPx={ARM_PX}
      testId="gizmo"
      placeOf={({ axis }) => ({ foot: placedMiddle(placement), value: placement.move[axis] })}
      step={moveStep(part)}
      onMove={({ axis }, value, drag) => movePart({ store, viewer }, part, axis, value, drag)}
    />
  );
}
