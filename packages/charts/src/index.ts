export { type ErrorTimeChart, errorTimeChart, frontPath, type PlacedPoint } from './error-time-chart.ts';
export { frameFacts, passTable, type TimeRow, timeNotes, timeRows, timeTable } from './frame-tables.ts';
export { type LabelBox, POINT_RADIUS_PX, placeAllLabels, placeLabels } from './place-labels.ts';
export { alignedColumns } from './text-table.ts';
