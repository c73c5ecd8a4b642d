// Increment per hidden light point: whole codes, of which 64 points fit into eight bits.
const HIDDEN_POINT: f32 = 3.0 / 255.0;
