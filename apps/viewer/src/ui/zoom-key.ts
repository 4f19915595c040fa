/** Name of the key with which the wheel zooms in a frame. */
export const ZOOM_KEY = /mac/i.test(navigator.platform) ? '⌘' : 'Ctrl';
