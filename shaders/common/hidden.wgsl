// What one hidden light point adds at its multisample position: a whole code, of which 16 points fit into eight bits.
const HIDDEN_POINT: f32 = 15.0 / 255.0;
