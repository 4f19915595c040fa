/**
 * Small parts over the picture, bundled: each alone would take longer to request than to transfer.
 */

export { ErrorMapImage, ErrorMapLegend, LookedPicture, SplitImage } from '../accuracy/compared-pictures.tsx';
export { AnnotationCard } from '../annotate/annotation-card.tsx';
export { AnnotationMarkers } from '../annotate/annotation-markers.tsx';
export { VolumeGizmo } from '../effects/volume-gizmo.tsx';
export { TravelBanner } from '../navigate/travel-banner.tsx';
export { PlaceGizmo } from '../scene/place-gizmo.tsx';
export { ModeLegend } from '../view-modes/mode-legend.tsx';
export { ModeMap } from '../view-modes/mode-map.tsx';
export { FramedWheel } from './framed-wheel.tsx';
export { Help } from './help.tsx';
export { KeptVersionsPanel, UnkeptPanel } from './kept-panels.tsx';
export { Notice } from './notice.tsx';
export { OverflowMenu } from './overflow-menu.tsx';
export { ReopenPanel } from './reopen-panel.tsx';
export { StreamPanel } from './stream-panel.tsx';
