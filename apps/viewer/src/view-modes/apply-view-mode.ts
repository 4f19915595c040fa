import type { EffectUse } from '@websplatter/core/effects';
import { shallow } from 'zustand/vanilla/shallow';
import type { Sphere } from '../camera/scene-bounds.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import type { ViewModeName } from '../state/view-mode.ts';
import { viewModeOf } from './view-modes.ts';

/** Draws each scene with the effects of the chosen view mode. */
export function applyViewMode(store: ViewerStore, viewer: Viewer): void {
  let made: { mode: ViewModeName; bounds: Sphere; uses: readonly EffectUse[] } | null = null;
  const focusDistance = () => viewer.camera.controls.pose.distance;
  const apply = () => {
    const { viewMode, requested } = store.getState();
    const bounds = viewer.camera.subjectSphere;
    if (!bounds) return;
    if (made?.mode !== viewMode || !isSameSphere(made.bounds, bounds))
      made = { mode: viewMode, bounds, uses: viewModeOf(viewMode).uses({ bounds, focusDistance }) };
    // A new scene starts without effects.
    const isAsked = requested['view-mode'].length > 0;
    if (requested['view-mode'] !== made.uses && (isAsked || made.uses.length > 0))
      viewer.setEffects('view-mode', made.uses);
  };
  apply();
  store.subscribe(
    ({ viewMode, scene, isFlipped, requested }) => [viewMode, scene, isFlipped, requested],
    apply,
    { equalityFn: shallow },
  );
}

function isSameSphere(a: Sphere, b: Sphere): boolean {
  return a.radius === b.radius && a.center.every((value, axis) => value === b.center[axis]);
}
