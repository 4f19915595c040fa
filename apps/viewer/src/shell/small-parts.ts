/** Parts over the picture, in one file: each is so small that asking for it takes longer than it. */
export { AnnotationCard } from '../annotations/annotation-card.tsx';
export { AnnotationMarkers } from '../annotations/annotation-markers.tsx';
export { ErrorMapImage } from '../comparison/error-map-image.tsx';
export { ErrorMapLegend } from '../comparison/error-map-legend.tsx';
export { SplitImage } from '../comparison/split-image.tsx';
export { ClipGizmo } from '../effects/clip-gizmo.tsx';
export { PlaceGizmo } from '../layout/place-gizmo.tsx';
export { LookedPicture } from '../measurement/looked-picture.tsx';
export { ReopenPanel } from '../messages/reopen-panel.tsx';
export { StreamPanel } from '../messages/stream-panel.tsx';
export { TravelBanner } from '../navigation/travel-banner.tsx';
export { ModeLegend } from '../view-modes/mode-legend.tsx';
export { ModeMap } from '../view-modes/mode-map.tsx';
export { Help } from './help.tsx';
