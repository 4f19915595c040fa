export { type ErrorTimeChart, errorTimeChart, frontPath, type PlacedPoint } from './error-time-chart.ts';
export { type LabelBox, POINT_RADIUS_PX, placeAllLabels, placeLabels } from './place-labels.ts';
export {
  alignedColumns,
  frameFacts,
  passTable,
  type TimeRow,
  timeNotes,
  timeRows,
  timeTable,
} from './tables.ts';
